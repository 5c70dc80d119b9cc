# IDL files -> C++ types of the installed Fast DDS: 2.9 (Debian 12) or 3.1 (Debian 13).
#
# Targets:
#   lapis_fastdds    Fast DDS itself, whichever version is installed
#   idl_<package>    types of one package; include "idl/<package>.hpp"

set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)   # also for the sibling directories that link our targets
find_package(fastcdr REQUIRED)
find_package(fastdds 3 QUIET)
if(fastdds_FOUND)
  set(LAPIS_FASTDDS_LIBRARIES fastdds fastcdr)
  # As 2.x always does: the plain CDR of ROS 2, and no announced type information.
  set(LAPIS_FASTDDSGEN_OPTIONS -default_extensibility final -no-typeobjectsupport)
  set(LAPIS_IDL_HEADER_SUFFIX .hpp)
  set(LAPIS_IDL_FILES .hpp PubSubTypes.hpp PubSubTypes.cxx CdrAux.hpp CdrAux.ipp)
else()
  find_package(fastrtps 2.9 REQUIRED)
  set(LAPIS_FASTDDS_LIBRARIES fastrtps fastcdr)
  set(LAPIS_FASTDDSGEN_OPTIONS "")
  set(LAPIS_IDL_HEADER_SUFFIX .h)
  set(LAPIS_IDL_FILES .h .cxx PubSubTypes.h PubSubTypes.cxx)
endif()
unset(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL)
find_program(FASTDDSGEN_EXECUTABLE fastddsgen REQUIRED)

add_library(lapis_fastdds INTERFACE)
target_link_libraries(lapis_fastdds INTERFACE ${LAPIS_FASTDDS_LIBRARIES})

set(LAPIS_FASTDDSGEN_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/run_fastddsgen.cmake)
set(LAPIS_TYPE_DESCRIPTIONS ${LAPIS_SOURCE_DIR}/idl/type_descriptions.py)
set(LAPIS_IDL_PARSER ${LAPIS_SOURCE_DIR}/idl/idl_parser.py)
set(LAPIS_IDL_INCLUDE_DIR ${CMAKE_BINARY_DIR}/idl/include)

# fastdds_idl_library(<package> IDL <file> [DEPENDS <package>...])
# Creates idl_<package>. Target properties IDL_FILES and IDL_DIRS hold the package's files and folders and those of
# everything it includes: a change of any of them generates again this package and those that depend on it, no other.
function(fastdds_idl_library package)
  cmake_parse_arguments(A "" "IDL" "DEPENDS" ${ARGN})
  set(target idl_${package})
  cmake_path(ABSOLUTE_PATH A_IDL NORMALIZE OUTPUT_VARIABLE idl)
  cmake_path(GET idl PARENT_PATH idl_dirs)
  set(idl_files ${idl})
  set(dependencies ${A_DEPENDS})
  list(TRANSFORM dependencies PREPEND idl_)
  foreach(dependency IN LISTS dependencies)
    get_target_property(files ${dependency} IDL_FILES)
    get_target_property(dirs ${dependency} IDL_DIRS)
    list(APPEND idl_files ${files})
    list(APPEND idl_dirs ${dirs})
  endforeach()
  list(REMOVE_DUPLICATES idl_files)
  list(REMOVE_DUPLICATES idl_dirs)
  list(JOIN idl_dirs "," include_dirs)
  list(JOIN LAPIS_FASTDDSGEN_OPTIONS "," options)

  set(out ${CMAKE_CURRENT_BINARY_DIR}/${package})
  set(names ${LAPIS_IDL_FILES})
  list(TRANSFORM names PREPEND ${package})
  set(generated ${names})
  list(TRANSFORM generated PREPEND ${out}/)
  list(JOIN names "," names)
  add_custom_command(
    OUTPUT ${out}/${package}.stamp BYPRODUCTS ${generated}
    COMMAND ${CMAKE_COMMAND} -D GENERATOR=${FASTDDSGEN_EXECUTABLE} -D OPTIONS=${options} -D IDL=${idl}
            -D INCLUDE_DIRS=${include_dirs} -D OUTPUT_DIR=${out} -D NAMES=${names} -P ${LAPIS_FASTDDSGEN_SCRIPT}
    DEPENDS ${idl_files} ${LAPIS_FASTDDSGEN_SCRIPT}
    COMMENT "fastddsgen ${package}" VERBATIM)

  set(header ${LAPIS_IDL_INCLUDE_DIR}/idl/${package}.hpp)
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${Python3_EXECUTABLE} -B ${LAPIS_TYPE_DESCRIPTIONS} header ${idl}
            --type-header ${package}PubSubTypes${LAPIS_IDL_HEADER_SUFFIX} --output ${header}
    DEPENDS ${idl_files} ${LAPIS_TYPE_DESCRIPTIONS} ${LAPIS_IDL_PARSER}
    COMMENT "type support ${package}" VERBATIM)

  set(sources ${generated})
  list(FILTER sources INCLUDE REGEX "cxx$")
  add_library(${target} STATIC ${sources} ${out}/${package}.stamp ${header})
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON IDL_FILES "${idl_files}"
                                             IDL_DIRS "${idl_dirs}")
  target_compile_options(${target} PRIVATE -w)
  target_include_directories(${target} SYSTEM PUBLIC ${out} ${LAPIS_IDL_INCLUDE_DIR})
  target_include_directories(${target} INTERFACE ${LAPIS_SOURCE_DIR})
  target_link_libraries(${target} PUBLIC ${dependencies} lapis_fastdds)
endfunction()
