# Lists the tests of a program of GoogleTest, and writes one test of ctest for several of them. Each of these is a process, and the
# start of a process takes longer than most tests do.
#
#     cmake -D PROGRAM=... -D NAME=... -D FILTER=... -D TESTS=N -D RESULTS=FOLDER -D PROPERTIES=a;b -D OUTPUT=FILE -P discover.cmake
#
# NAME: what the names of the tests of ctest begin with. FILTER: a pattern of --gtest_filter. TESTS: the most tests of a suite that one process runs. RESULTS: where the
# processes write the outcome of each test, as NAME_OF_THE_TEST.xml. PROPERTIES: properties of the tests of ctest. OUTPUT: a file for ctest to include.
execute_process(COMMAND ${PROGRAM} --gtest_filter=${FILTER} --gtest_list_tests
                OUTPUT_VARIABLE listed RESULT_VARIABLE status ERROR_VARIABLE errors)
if(status)
    message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${status}\n${errors}")
endif()
string(REGEX REPLACE " *#[^\n]*" "" listed "${listed}")  # values of parameters
string(REPLACE ";" "\\;" listed "${listed}")
string(REPLACE "\n" ";" lines "${listed}")

set(text)
# Adds a test of ctest for the collected tests of a suite, and begins the next collection.
macro(finish)
    if(members)
        set(name ${NAME}.${suite})
        list(LENGTH members size)
        if(size EQUAL 1)
            string(APPEND name .${members})
        elseif(part GREATER 1 OR rest)
            string(APPEND name .part_${part})
        endif()
        list(TRANSFORM members PREPEND "${suite}." OUTPUT_VARIABLE patterns)
        list(JOIN patterns ":" patterns)
        string(REPLACE "/" "_" file ${name})
        string(APPEND text "add_test([==[${name}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${patterns}]==] "
                           "[==[--gtest_output=xml:${RESULTS}/${file}.xml]==])\n"
                           "set_tests_properties([==[${name}]==] PROPERTIES ${PROPERTIES})\n")
        math(EXPR part "${part} + 1")
    endif()
    set(members)
endmacro()

set(members)
foreach(line IN LISTS lines)
    if(line MATCHES "^  (.+)$")
        set(test ${CMAKE_MATCH_1})
        list(LENGTH members size)
        if(size EQUAL TESTS)
            set(rest TRUE)
            finish()
        endif()
        list(APPEND members ${test})
    elseif(line MATCHES "^([^ ]+)\\.$")
        set(next ${CMAKE_MATCH_1})
        finish()
        set(suite ${next})
        set(part 1)
        set(rest FALSE)
    endif()
endforeach()
finish()
file(WRITE ${OUTPUT}.new "${text}")
file(RENAME ${OUTPUT}.new ${OUTPUT})
