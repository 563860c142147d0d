# Runs the portfile of the port with stand-ins for the functions of vcpkg, as vcpkg runs it for a release build.
#
#     cmake -D PORTFILE=... -D BUILD=... -D PACKAGE=... -D FEATURES=a;b -P vcpkg_port.cmake
#
# PORTFILE: portfile.cmake. BUILD: folder for the build. PACKAGE: folder for the installed files. Requires: PACKAGE is empty.
cmake_minimum_required(VERSION 3.25)
set(PORT octopair)
set(CURRENT_PACKAGES_DIR ${PACKAGE})

# Runs a command, and shows its output only if it fails.
function(run_quietly)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(status)
        message(FATAL_ERROR "${ARGN}\n${output}")
    endif()
endfunction()

# Sets an option of CMake for each feature of the list: ON if the feature is wanted.
function(vcpkg_check_features)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "OUT_FEATURE_OPTIONS" "FEATURES")
    set(options)
    while(arg_FEATURES)
        list(POP_FRONT arg_FEATURES feature option)
        if(feature IN_LIST FEATURES)
            list(APPEND options -D${option}=ON)
        else()
            list(APPEND options -D${option}=OFF)
        endif()
    endwhile()
    set(${arg_OUT_FEATURE_OPTIONS} ${options} PARENT_SCOPE)
endfunction()

function(vcpkg_cmake_configure)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "SOURCE_PATH" "OPTIONS")
    # OCTOPAIR_WARNINGS_AS_ERRORS makes the compiler commands equal to those of the presets, so ccache has them.
    run_quietly(${CMAKE_COMMAND} --fresh -S ${arg_SOURCE_PATH} -B ${BUILD} -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF
                -DCMAKE_INSTALL_PREFIX=${PACKAGE} -DCMAKE_INSTALL_LIBDIR=lib -DOCTOPAIR_WARNINGS_AS_ERRORS=ON
                ${arg_OPTIONS})
endfunction()

function(vcpkg_cmake_install)
    run_quietly(${CMAKE_COMMAND} --build ${BUILD} --target install)
endfunction()

# Moves the package of CMake to share/PORT, and corrects the paths in it, which are one level less deep there.
function(vcpkg_cmake_config_fixup)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "CONFIG_PATH" "")
    file(GLOB files ${PACKAGE}/${arg_CONFIG_PATH}/*.cmake)
    if(NOT files)
        message(FATAL_ERROR "vcpkg_cmake_config_fixup: no file in ${arg_CONFIG_PATH}")
    endif()
    set(up "get_filename_component(_IMPORT_PREFIX \"\${_IMPORT_PREFIX}\" PATH)\n")
    foreach(file IN LISTS files)
        file(READ ${file} text)
        string(REPLACE "${up}${up}${up}" "${up}${up}" text "${text}")
        string(REPLACE "{CMAKE_CURRENT_LIST_DIR}/../../../" "{CMAKE_CURRENT_LIST_DIR}/../../" text "${text}")
        get_filename_component(name ${file} NAME)
        file(WRITE ${PACKAGE}/share/${PORT}/${name} "${text}")
    endforeach()
    file(REMOVE_RECURSE ${PACKAGE}/lib/cmake)
endfunction()

# The test does not use files of pkg-config.
function(vcpkg_fixup_pkgconfig)
endfunction()

function(vcpkg_copy_tools)
    cmake_parse_arguments(PARSE_ARGV 0 arg "AUTO_CLEAN" "" "TOOL_NAMES")
    foreach(tool IN LISTS arg_TOOL_NAMES)
        file(COPY ${PACKAGE}/bin/${tool} DESTINATION ${PACKAGE}/tools/${PORT})
    endforeach()
    if(arg_AUTO_CLEAN)
        file(REMOVE_RECURSE ${PACKAGE}/bin)
    endif()
endfunction()

function(vcpkg_install_copyright)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "FILE_LIST")
    file(INSTALL ${arg_FILE_LIST} DESTINATION ${PACKAGE}/share/${PORT} RENAME copyright)
endfunction()

include(${PORTFILE})
