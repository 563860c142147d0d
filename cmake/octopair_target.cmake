# Compile options of every target of this project.
#
# -ffp-contract=off: with a fused multiply-add on some machines only, equal scenes would give different bytes.

set_property(GLOBAL PROPERTY USE_FOLDERS ON)
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

# Paths in messages begin at the root. So checkouts in other folders give the same code, and a compiler cache serves them all. Debug
# information of packages has such paths, too; release builds have the same options, so that packages can take their objects from the
# cache.
if(OCTOPAIR_PACKAGE_BUILD OR (PROJECT_IS_TOP_LEVEL AND CMAKE_BUILD_TYPE STREQUAL "Release"))
    add_compile_options(-ffile-prefix-map=${PROJECT_BINARY_DIR}=build -ffile-prefix-map=${PROJECT_SOURCE_DIR}=.)
elseif(PROJECT_IS_TOP_LEVEL)
    add_compile_options(-fmacro-prefix-map=${PROJECT_SOURCE_DIR}=.)
endif()

function(octopair_target target)
    target_compile_features(${target} PUBLIC cxx_std_20)
    set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON
                          CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    target_compile_options(${target} PRIVATE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                             -Wold-style-cast -Wcast-align -Woverloaded-virtual -Wconversion
                                             -Wno-sign-conversion)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # g++ 12 wrongly reports overlapping copies in "text" + std::string (GCC bug 105651).
        # -Wno-psabi: no note on an ABI that changed in GCC 4.6.
        target_compile_options(${target} PRIVATE -Wno-restrict -Wno-psabi)
        if(CMAKE_UNITY_BUILD)
            # g++ treats the sources that a unity file includes as headers.
            target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
        endif()
    endif()
    if(OCTOPAIR_WARNINGS_AS_ERRORS)
        target_compile_options(${target} PRIVATE -Werror)
    endif()
    if(OCTOPAIR_TEST_HOOKS)
        target_compile_definitions(${target} PRIVATE OCTOPAIR_TEST_HOOKS)
    endif()
    if(OCTOPAIR_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=${OCTOPAIR_SANITIZE} -fno-omit-frame-pointer
                                                 -fno-sanitize-recover=all)
        target_link_options(${target} PUBLIC -fsanitize=${OCTOPAIR_SANITIZE})
        # Kernels have up to three versions of a step: for AVX-512 with and without VBMI2, and for all others. AddressSanitizer tests all
        # (octopair_instruction_sets). ThreadSanitizer builds only the oldest and the newest sets, because kernels use no threads. SSSE3
        # and SSE4 have the source of AVX2; release builds test them.
        set(disabled "HWY_SSSE3|HWY_SSE4")
        if(NOT OCTOPAIR_SANITIZE MATCHES address)
            string(APPEND disabled "|HWY_AVX2")
        endif()
        target_compile_definitions(${target} PRIVATE "HWY_DISABLED_TARGETS=(${disabled})")
    endif()
endfunction()

# Compiles these targets with -O1 in sanitized builds, because their code runs long in tests. The presets for sanitizers compile
# everything else with -O0, for which clang takes a quarter of the time.
function(octopair_optimise_sanitized)
    if(OCTOPAIR_SANITIZE)
        foreach(target IN LISTS ARGN)
            target_compile_options(${target} PRIVATE -O1)
        endforeach()
    endif()
endfunction()

# Compiles these sources separately, without unity files: Highway includes each source again for each instruction set.
function(octopair_kernels)
    set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
