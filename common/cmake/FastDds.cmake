# lapis_fastdds: Fast DDS, whichever version is installed: 2.9 (Debian 12) or 3.1 (Debian 13).
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)   # also for the sibling directories that link our targets
find_package(fastcdr REQUIRED)
find_package(fastdds 3 QUIET)
if(NOT fastdds_FOUND)
  find_package(fastrtps 2.9 REQUIRED)
endif()
unset(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL)

add_library(lapis_fastdds INTERFACE)
target_link_libraries(lapis_fastdds INTERFACE $<IF:$<TARGET_EXISTS:fastdds>,fastdds,fastrtps>)
