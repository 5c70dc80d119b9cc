# One run of fastddsgen; called by FastddsIdl.cmake at build time:
#   cmake -D GENERATOR=<program> -D OPTIONS=a,b -D IDL=<file> -D INCLUDE_DIRS=a,b -D OUTPUT_DIR=<dir> -D NAMES=a,b
#         -P <this file>
#
# fastddsgen writes the code of every included IDL file beside the wanted one, and its preprocessed input to a name in
# /tmp that parallel runs share. So each run has its own temporary folder, and only the package's own files leave it.
cmake_policy(VERSION 3.25)
cmake_path(GET IDL STEM package)
set(scratch ${OUTPUT_DIR}/generating)
file(REMOVE_RECURSE ${scratch})
file(MAKE_DIRECTORY ${scratch}/preprocessed ${scratch}/code)

string(REPLACE "," ";" OPTIONS "${OPTIONS}")
string(REPLACE "," ";" INCLUDE_DIRS "${INCLUDE_DIRS}")
list(TRANSFORM INCLUDE_DIRS PREPEND "-I;")
execute_process(
  COMMAND ${GENERATOR} -cs -typeros2 -replace ${OPTIONS} ${INCLUDE_DIRS} -t ${scratch}/preprocessed -d ${scratch}/code
          ${IDL}
  RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
if(NOT status EQUAL 0 OR log MATCHES "error:")
  message(FATAL_ERROR "fastddsgen failed on ${IDL} (status ${status}):\n${log}")
endif()

# Files whose content stayed the same keep their time, so nothing is compiled twice.
string(REPLACE "," ";" NAMES "${NAMES}")
foreach(name IN LISTS NAMES)
  file(COPY_FILE ${scratch}/code/${name} ${OUTPUT_DIR}/${name} ONLY_IF_DIFFERENT)
endforeach()
file(REMOVE_RECURSE ${scratch})
file(TOUCH ${OUTPUT_DIR}/${package}.stamp)
