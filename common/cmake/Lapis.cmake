# The few helper functions of this build.

# The root of the repository: include root of everything; components/ is the second one.
get_filename_component(LAPIS_SOURCE_DIR "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)

# Compiler settings that every target of our own code uses (generated code does not).
option(LAPIS_WARNINGS_AS_ERRORS "A warning in our own code ends the build" OFF)
add_library(lapis_warnings INTERFACE)
target_compile_options(lapis_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                       $<$<BOOL:${LAPIS_WARNINGS_AS_ERRORS}>:-Werror>)

if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # It warns of types in anonymous namespaces of included files, which the sources of a unit are.
  target_compile_options(lapis_warnings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
endif()

# lapis_library(<name> SOURCES <file>... [HEADERS <file>...] [LINK <target>...] [PRIVATE_LINK <target>...])
# A static library of our own code. Every header stands alone: a source includes its own header first (.ci/run checks it),
# and HEADERS without a source are compiled by themselves (target all_verify_interface_header_sets).
function(lapis_library name)
  cmake_parse_arguments(A "" "" "SOURCES;HEADERS;LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name} STATIC ${A_SOURCES})
  set(base ${LAPIS_SOURCE_DIR})
  string(FIND ${CMAKE_CURRENT_SOURCE_DIR}/ ${LAPIS_SOURCE_DIR}/components/ position)
  if(position EQUAL 0)
    set(base ${LAPIS_SOURCE_DIR}/components)
  endif()
  set(headers_only ${A_HEADERS})
  list(TRANSFORM A_SOURCES REPLACE "\\.cpp$" ".hpp" OUTPUT_VARIABLE headers_of_sources)
  list(REMOVE_ITEM headers_only ${headers_of_sources})
  target_sources(${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${base} FILES ${headers_only})
  target_include_directories(${name} PUBLIC ${LAPIS_SOURCE_DIR} ${LAPIS_SOURCE_DIR}/components)
  set_target_properties(${name} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON LINKER_LANGUAGE CXX)
  target_link_libraries(${name} PUBLIC ${A_LINK} PRIVATE ${A_PRIVATE_LINK} lapis_warnings)
endfunction()

# lapis_executable(<target> OUTPUT <file name> SOURCES <file>... [LINK <target>...])
function(lapis_executable name)
  cmake_parse_arguments(A "" "OUTPUT" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${A_SOURCES})
  set_target_properties(${name} PROPERTIES OUTPUT_NAME ${A_OUTPUT})
  target_link_libraries(${name} PRIVATE ${A_LINK} lapis_warnings)
endfunction()

# lapis_unit_test(<name> [HEAVY] SOURCES <file>... [LINK <target>...])
# A GoogleTest executable of the unit tier: no DDS, no shared data needed to pass. One for a folder, not one for a file: the
# sources are compiled together (CONTRIBUTING.md, "The compiler's work"), and every executable links OpenCV and the like.
# HEAVY: its own sources work hard (render rooms, drive through worlds) and are compiled with -O1 wherever tests' sources
# have an option of their own.
function(lapis_unit_test name)
  cmake_parse_arguments(A "HEAVY" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${A_SOURCES})
  target_link_libraries(${name} PRIVATE ${A_LINK} GTest::gtest GTest::gmock GTest::gtest_main lapis_warnings)
  if(A_HEAVY AND LAPIS_TEST_OPTIMISATION)
    target_compile_options(${name} PRIVATE -O1)
  else()
    target_compile_options(${name} PRIVATE ${LAPIS_TEST_OPTIMISATION})
  endif()
  add_test(NAME unit.${name} COMMAND ${name})
  set_tests_properties(unit.${name} PROPERTIES LABELS unit TIMEOUT 600) # against hanging: sanitizers on a slow day take 300
endfunction()
