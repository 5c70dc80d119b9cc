# IDL files -> C++ types: targets idl_<package>, with the header "idl/<package>.hpp".

set(LAPIS_TYPE_DESCRIPTIONS ${LAPIS_SOURCE_DIR}/idl/type_descriptions.py)
set(LAPIS_IDL_SCRIPTS ${LAPIS_TYPE_DESCRIPTIONS} ${LAPIS_SOURCE_DIR}/idl/cpp_types.py ${LAPIS_SOURCE_DIR}/idl/idl_parser.py)
set(LAPIS_IDL_INCLUDE_DIR ${CMAKE_BINARY_DIR}/idl/include)

# lapis_idl_library(<package> IDL <file> [DEPENDS <package>...])
# Creates idl_<package>. Its property IDL_FILES holds the package's file and those of everything it includes: a change
# of any of them generates again this package and those that depend on it, no other.
function(lapis_idl_library package)
  cmake_parse_arguments(A "" "IDL" "DEPENDS" ${ARGN})
  set(target idl_${package})
  cmake_path(ABSOLUTE_PATH A_IDL NORMALIZE OUTPUT_VARIABLE idl)
  set(idl_files ${idl})
  set(dependencies ${A_DEPENDS})
  list(TRANSFORM dependencies PREPEND idl_)
  foreach(dependency IN LISTS dependencies)
    get_target_property(files ${dependency} IDL_FILES)
    list(APPEND idl_files ${files})
  endforeach()
  list(REMOVE_DUPLICATES idl_files)

  set(header ${LAPIS_IDL_INCLUDE_DIR}/idl/${package}.hpp)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${package}.cpp)
  add_custom_command(
    OUTPUT ${package}.stamp BYPRODUCTS ${header} ${source}
    COMMAND ${Python3_EXECUTABLE} -B ${LAPIS_TYPE_DESCRIPTIONS} cpp ${idl} --header ${header} --source ${source}
    COMMAND ${CMAKE_COMMAND} -E touch ${package}.stamp
    DEPENDS ${idl_files} ${LAPIS_IDL_SCRIPTS}
    COMMENT "C++ of ${package}" VERBATIM)

  add_library(${target} STATIC ${source} ${package}.stamp)
  set_target_properties(${target} PROPERTIES IDL_FILES "${idl_files}")
  target_include_directories(${target} PUBLIC ${LAPIS_IDL_INCLUDE_DIR} ${LAPIS_SOURCE_DIR})
  target_link_libraries(${target} PUBLIC ${dependencies} PRIVATE lapis_warnings)
endfunction()
