# Builds the source tree that contains this port. vcpkg builds again only after a change of the port's own files.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS
    FEATURES
        client OCTOPAIR_WITH_SERVICE
        meshes OCTOPAIR_WITH_MESHES
        mpi OCTOPAIR_WITH_MPI
        pipeline OCTOPAIR_WITH_PIPELINE
        processes OCTOPAIR_WITH_PROCESSES
        program OCTOPAIR_BUILD_PROGRAM
        systemd OCTOPAIR_WITH_SYSTEMD
        viewer OCTOPAIR_WITH_VIEWER)

string(COMPARE EQUAL "${VCPKG_LIBRARY_LINKAGE}" dynamic SHARED)

# The worker program is a tool: vcpkg allows no programs in other folders.
vcpkg_cmake_configure(
    SOURCE_PATH "${SOURCE_PATH}"
    OPTIONS
        ${FEATURE_OPTIONS}
        -DOCTOPAIR_SHARED_LIBS=${SHARED}
        -DOCTOPAIR_PACKAGE_BUILD=ON
        -DOCTOPAIR_WITH_ADAPTERS=ON
        -DOCTOPAIR_WITH_C=OFF
        -DOCTOPAIR_WITH_IFC=OFF
        -DOCTOPAIR_WITH_PYTHON=OFF
        -DOCTOPAIR_WITH_STEP=OFF
        -DOCTOPAIR_BUILD_TESTS=OFF
        -DOCTOPAIR_BUILD_BENCHMARKS=OFF
        -DCMAKE_INSTALL_LIBEXECDIR=tools)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/octopair)
if(EXISTS "${CURRENT_PACKAGES_DIR}/lib/pkgconfig")
    vcpkg_fixup_pkgconfig()
endif()
if("program" IN_LIST FEATURES)
    vcpkg_copy_tools(TOOL_NAMES octopair AUTO_CLEAN)
endif()

# The units of systemd name the folder of the build. The manual belongs to the program of an installed system.
file(REMOVE_RECURSE
    "${CURRENT_PACKAGES_DIR}/debug/include"
    "${CURRENT_PACKAGES_DIR}/debug/share"
    "${CURRENT_PACKAGES_DIR}/debug/lib/systemd"
    "${CURRENT_PACKAGES_DIR}/debug/tools"
    "${CURRENT_PACKAGES_DIR}/lib/systemd"
    "${CURRENT_PACKAGES_DIR}/share/doc"
    "${CURRENT_PACKAGES_DIR}/share/man")
file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
