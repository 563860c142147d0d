# Shared libraries and the names that users link.
#
# octopair_shared_library(TARGET OBJECTS object... [PUBLIC library...] [PRIVATE library...])
#     Adds TARGET_shared if OCTOPAIR_SHARED_LIBS is on.
#     - TARGET is a static library. TARGET_shared consists of the same objects, so nothing is compiled twice. Programs and
#       tests of this project link the static libraries; the interfaces for C and Python link the shared ones.
#     - TARGET.map in the caller's folder lists the exported symbols. Without this file, cmake/component.map does.
#     - The SONAME has the number OCTOPAIR_SOVERSION. tests/packaging/abi.sh checks that the interface fits it.
#
# octopair_alias(NAME TARGET)
#     Adds octopair::NAME. In a parent project with BUILD_SHARED_LIBS it is the shared library, otherwise the static one.

function(octopair_shared_library target)
    if(NOT OCTOPAIR_SHARED_LIBS)
        return()
    endif()
    cmake_parse_arguments(PARSE_ARGV 1 SHARED "" "" "OBJECTS;PUBLIC;PRIVATE")
    set(shared ${target}_shared)
    set(script ${CMAKE_CURRENT_SOURCE_DIR}/${target}.map)
    if(NOT EXISTS ${script})
        set(script ${PROJECT_SOURCE_DIR}/cmake/component.map)
    endif()
    set(exports ${CMAKE_CURRENT_BINARY_DIR}/${target}.map)
    configure_file(${script} ${exports} @ONLY)
    get_target_property(export_name ${target} EXPORT_NAME)
    if(NOT export_name)
        set(export_name ${target})
    endif()

    add_library(${shared} SHARED ${SHARED_OBJECTS})
    target_compile_features(${shared} PUBLIC cxx_std_20)
    target_link_libraries(${shared} PUBLIC ${SHARED_PUBLIC} PRIVATE ${SHARED_PRIVATE})
    target_include_directories(${shared} INTERFACE
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    # nodelete: threads of oneTBB run on after the last engine, so dlclose() must not unload the code.
    target_link_options(${shared} PRIVATE -Wl,--version-script=${exports} -Wl,-z,nodelete -Wl,-z,defs)
    set_target_properties(${shared} PROPERTIES
        OUTPUT_NAME ${target} EXPORT_NAME ${export_name} LINKER_LANGUAGE CXX INSTALL_RPATH "$ORIGIN"
        VERSION ${PROJECT_VERSION} SOVERSION ${OCTOPAIR_SOVERSION} LINK_DEPENDS ${exports})
endfunction()

function(octopair_alias name target)
    if(TARGET ${target}_shared AND BUILD_SHARED_LIBS AND NOT PROJECT_IS_TOP_LEVEL)
        add_library(octopair::${name} ALIAS ${target}_shared)
    else()
        add_library(octopair::${name} ALIAS ${target})
    endif()
endfunction()
