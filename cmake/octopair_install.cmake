# Installed tree: headers, static and shared libraries with their CMake package and pkg-config files, programs, the manual,
# completions of shells, and files to run a server.

if(NOT PROJECT_IS_TOP_LEVEL)
    return()
endif()
include(CMakePackageConfigHelpers)
set(cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/octopair)

# Installs the libraries of a component: octopair_install_libraries(COMPONENT target...). A target is a static library; its
# shared library is installed, too. The files octopair_COMPONENT_static.cmake and octopair_COMPONENT_shared.cmake define
# targets of the same names.
function(octopair_install_libraries component)
    install(TARGETS ${ARGN} EXPORT octopair_${component}_static)
    install(EXPORT octopair_${component}_static NAMESPACE octopair:: DESTINATION ${cmake_folder})
    if(OCTOPAIR_SHARED_LIBS)
        list(TRANSFORM ARGN APPEND _shared)
        install(TARGETS ${ARGN} EXPORT octopair_${component}_shared)
        install(EXPORT octopair_${component}_shared NAMESPACE octopair:: DESTINATION ${cmake_folder})
    endif()
endfunction()

# Installs a file for pkg-config: octopair_install_pkgconfig(NAME DESCRIPTION LIBRARY [REQUIRES package] [STATIC library...]).
# STATIC are the libraries that a program links in addition if it links LIBRARY statically. These are not named as packages
# of pkg-config, which would have to be installed for shared libraries, too.
function(octopair_install_pkgconfig name description library)
    cmake_parse_arguments(PARSE_ARGV 3 PC "" "REQUIRES" "STATIC")
    list(TRANSFORM PC_STATIC PREPEND -l)
    list(JOIN PC_STATIC " " static_libraries)
    cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_LIBDIR BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE libdir)
    cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_INCLUDEDIR BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE includedir)
    cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig OUTPUT_VARIABLE prefix)
    configure_file(cmake/octopair.pc.in ${PROJECT_BINARY_DIR}/pkgconfig/${name}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/pkgconfig/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

install(DIRECTORY include/octopair DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(FILES ${PROJECT_BINARY_DIR}/include/octopair/version.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/octopair)
octopair_install_libraries(core octopair)
octopair_install_pkgconfig(octopair "Every colliding pair among millions of moving 3D objects" octopair
                           STATIC tbb hwy)
if(OCTOPAIR_WITH_PIPELINE)
    octopair_install_libraries(pipeline octopair_pipeline)
    octopair_install_pkgconfig(octopair-pipeline "Exact collisions of shapes and meshes, and filters of pairs" octopair_pipeline
                               REQUIRES "octopair = ${PROJECT_VERSION}" STATIC hwy)
endif()
if(OCTOPAIR_WITH_PROCESSES)
    install(TARGETS octopair_worker EXPORT octopair_worker RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/octopair)
    install(EXPORT octopair_worker NAMESPACE octopair:: DESTINATION ${cmake_folder})
    octopair_install_libraries(processes octopair_processes octopair_processes_with_worker)
    octopair_install_pkgconfig(octopair-processes "octopair's engine of worker processes" octopair_processes
                               REQUIRES "octopair = ${PROJECT_VERSION}")
endif()
if(OCTOPAIR_WITH_MPI)
    octopair_install_libraries(mpi octopair_mpi)
    octopair_install_pkgconfig(octopair-mpi "octopair's engine of MPI ranks; the compiler of MPI adds MPI" octopair_mpi
                               REQUIRES "octopair = ${PROJECT_VERSION}" STATIC hwy)
endif()
if(OCTOPAIR_WITH_SERVICE)
    octopair_install_libraries(client octopair_client)
    octopair_install_pkgconfig(octopair-client "Engines, scenes and jobs of an octopair server" octopair_client
                               REQUIRES "octopair = ${PROJECT_VERSION}" STATIC grpc++ grpc gpr protobuf crypto)
    install(FILES src/service/protocol/octopair.proto DESTINATION ${CMAKE_INSTALL_DATADIR}/octopair)
endif()
if(OCTOPAIR_WITH_VIEWER)
    octopair_install_libraries(viewer octopair_viewer)
    octopair_install_pkgconfig(octopair-viewer "A view of a running octopair scene in a browser" octopair_viewer
                               REQUIRES "octopair = ${PROJECT_VERSION}" STATIC z)
endif()
if(OCTOPAIR_WITH_C)
    install(FILES c/include/octopair.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
    install(TARGETS octopair_c EXPORT octopair_c)
    install(EXPORT octopair_c NAMESPACE octopair:: DESTINATION ${cmake_folder})
    if(TARGET octopair_c_client)
        install(TARGETS octopair_c_client LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/octopair${OCTOPAIR_SOVERSION})
    endif()
    octopair_install_pkgconfig(octopair-c "octopair for C" octopair_c)
endif()
configure_package_config_file(cmake/octopair-config.cmake.in ${PROJECT_BINARY_DIR}/octopair-config.cmake
                              INSTALL_DESTINATION ${cmake_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/octopair-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/octopair-config.cmake ${PROJECT_BINARY_DIR}/octopair-config-version.cmake
        DESTINATION ${cmake_folder})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(OCTOPAIR_BUILD_PROGRAM)
    install(TARGETS octopair_program)
    install(FILES docs/octopair.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
    install(FILES src/cli/octopair.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
            RENAME octopair)
    install(FILES src/cli/_octopair DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
    install(FILES src/cli/octopair.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
    if(OCTOPAIR_WITH_SERVICE)
        set(OCTOPAIR_SERVICE_TYPE "Type=exec")
        if(OCTOPAIR_WITH_SYSTEMD)
            set(OCTOPAIR_SERVICE_TYPE "Type=notify\n# The server reports twice in this time that it works. Otherwise systemd restarts it.\nWatchdogSec=30")
        endif()
        configure_file(packaging/octopair.service ${PROJECT_BINARY_DIR}/octopair.service @ONLY)
        install(FILES ${PROJECT_BINARY_DIR}/octopair.service packaging/octopair.socket DESTINATION lib/systemd/system)
        install(FILES packaging/serve.toml packaging/grafana.json DESTINATION ${CMAKE_INSTALL_DATADIR}/octopair)
        install(DIRECTORY packaging/proxy DESTINATION ${CMAKE_INSTALL_DATADIR}/octopair)
    endif()
endif()
if(OCTOPAIR_BUILD_BENCHMARKS)
    install(TARGETS octopair_bench_program)
    install(FILES docs/octopair-bench.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()
