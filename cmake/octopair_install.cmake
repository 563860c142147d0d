# The installed tree: headers, the libraries with their CMake package, the programs, the manual and the completion, and
# what a server is run with.

if(NOT PROJECT_IS_TOP_LEVEL)
    return()
endif()
include(CMakePackageConfigHelpers)

install(DIRECTORY include/octopair DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(FILES ${PROJECT_BINARY_DIR}/include/octopair/version.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/octopair)
install(TARGETS octopair EXPORT octopair_targets)
install(EXPORT octopair_targets NAMESPACE octopair:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/octopair)
if(OCTOPAIR_WITH_PIPELINE)
    install(TARGETS octopair_pipeline EXPORT octopair_pipeline_targets)
    install(EXPORT octopair_pipeline_targets NAMESPACE octopair:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/octopair)
endif()
if(OCTOPAIR_WITH_PROCESSES)
    install(TARGETS octopair_worker EXPORT octopair_processes_targets
            RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/octopair)
    install(TARGETS octopair_processes octopair_processes_with_worker EXPORT octopair_processes_targets)
    install(EXPORT octopair_processes_targets NAMESPACE octopair::
            DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/octopair)
endif()
if(OCTOPAIR_WITH_MPI)
    install(TARGETS octopair_mpi EXPORT octopair_mpi_targets)
    install(EXPORT octopair_mpi_targets NAMESPACE octopair:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/octopair)
endif()
if(OCTOPAIR_WITH_SERVICE)
    install(TARGETS octopair_client EXPORT octopair_client_targets)
    install(EXPORT octopair_client_targets NAMESPACE octopair:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/octopair)
    install(FILES src/service/protocol/octopair.proto DESTINATION ${CMAKE_INSTALL_DATADIR}/octopair)
endif()
configure_package_config_file(cmake/octopair-config.cmake.in ${PROJECT_BINARY_DIR}/octopair-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/octopair)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/octopair-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/octopair-config.cmake ${PROJECT_BINARY_DIR}/octopair-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/octopair)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(OCTOPAIR_BUILD_PROGRAM)
    install(TARGETS octopair_program)
    install(FILES docs/octopair.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
    install(FILES src/cli/octopair.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
            RENAME octopair)
    if(OCTOPAIR_WITH_SERVICE)
        configure_file(packaging/octopair.service ${PROJECT_BINARY_DIR}/octopair.service @ONLY)
        install(FILES ${PROJECT_BINARY_DIR}/octopair.service DESTINATION lib/systemd/system)
        install(FILES packaging/serve.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/octopair)
    endif()
endif()
