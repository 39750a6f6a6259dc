# For the firmware, the Pico W differs from the Pico only in the pin of the status LED (board.hpp).
include(${CMAKE_CURRENT_LIST_DIR}/../pico/board.cmake)
