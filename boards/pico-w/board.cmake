# The Pico W has the same properties as the Pico. Only the pin of the status LED differs (board.hpp).
include(${CMAKE_CURRENT_LIST_DIR}/../pico/board.cmake)
unset(test_programs)  # the presets of the Pico build these programs
