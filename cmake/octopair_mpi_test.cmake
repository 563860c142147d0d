# What tests under mpirun run with.
#
# Open MPI's settings for more ranks than cores, and for root in containers; other MPIs do not look at them.

set(OCTOPAIR_MPI_TEST_ENVIRONMENT OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_mpi_yield_when_idle=1
    OMPI_MCA_hwloc_base_binding_policy=none OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1)
# MPI keeps memory until the program ends, and some beyond.
if(OCTOPAIR_SANITIZE MATCHES address)
    list(APPEND OCTOPAIR_MPI_TEST_ENVIRONMENT ASAN_OPTIONS=detect_leaks=0)
endif()
