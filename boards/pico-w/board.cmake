# A Pico W differs from a Pico only in board.hpp.
include(${CMAKE_CURRENT_LIST_DIR}/../pico/board.cmake)
unset(test_programs)  # these programs run on a Pico
