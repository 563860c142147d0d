# Environment of tests under mpirun.
#
# Settings of Open MPI allow more ranks than cores, and root in containers. Other MPIs ignore them.

set(OCTOPAIR_MPI_TEST_ENVIRONMENT OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_mpi_yield_when_idle=1
    OMPI_MCA_hwloc_base_binding_policy=none OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1)
# MPI does not free all of its memory before the program ends, which LeakSanitizer would report.
if(OCTOPAIR_SANITIZE MATCHES address)
    list(APPEND OCTOPAIR_MPI_TEST_ENVIRONMENT ASAN_OPTIONS=detect_leaks=0)
endif()
