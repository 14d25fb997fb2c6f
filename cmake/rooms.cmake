# A room is a folder of src/dapple with its own target. USES names the rooms it may include: the build links exactly
# these, and scripts/check_edges.py (a test) fails on any #include outside of them.
function(dapple_room name)
  cmake_parse_arguments(ROOM "" "" "USES;LIBRARIES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(sources)
    add_library(dapple_${name} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(dapple_${name} PRIVATE ${ROOM_LIBRARIES})
  else()
    add_library(dapple_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(dapple_${name} ${scope} ${PROJECT_SOURCE_DIR}/src)
  foreach(used IN LISTS ROOM_USES)
    target_link_libraries(dapple_${name} ${scope} dapple_${used})
  endforeach()
endfunction()

# Gives ctest a program of tests as a few processes (LABEL.NAME, or LABEL.N for the SHARDS of a ring): each process takes
# 0.3 s to load the libraries of OpenImageIO, which for a thousand processes of one short test each would be half of all
# test time.
# One test alone: build/release/bin/test_NAME --gtest_filter=PATTERN.
function(dapple_gtest target)
  cmake_parse_arguments(TEST "" "LABEL;SHARDS;TIMEOUT;COST" "" ${ARGN})
  string(REPLACE "test_" "" name ${target})
  set(shards 1)
  if(TEST_SHARDS)
    set(shards ${TEST_SHARDS})
  endif()
  foreach(shard RANGE 1 ${shards})
    set(test ${TEST_LABEL}.${name})
    if(shards GREATER 1)
      set(test ${TEST_LABEL}.${shard})
    endif()
    math(EXPR index "${shard} - 1")
    add_test(NAME ${test} COMMAND ${target} --gtest_brief=1)
    set_tests_properties(${test} PROPERTIES LABELS ${TEST_LABEL} TIMEOUT ${TEST_TIMEOUT} COST ${TEST_COST}
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${index}")
  endforeach()
endfunction()

# One test program per folder of tests/unit, named after the room it tests.
function(dapple_test name)
  cmake_parse_arguments(TEST "" "" "USES;LIBRARIES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  add_executable(test_${name} ${sources})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)  # "support/..."
  target_link_libraries(test_${name} PRIVATE GTest::gtest_main ${TEST_LIBRARIES})
  foreach(used IN LISTS TEST_USES)
    target_link_libraries(test_${name} PRIVATE dapple_${used})
  endforeach()
  target_compile_definitions(test_${name} PRIVATE DAPPLE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  dapple_gtest(test_${name} LABEL unit TIMEOUT 300 COST 5)
endfunction()
