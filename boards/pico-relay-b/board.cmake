include(${CMAKE_CURRENT_LIST_DIR}/../pico/board.cmake)

# The models that this board has pins for.
set(most_inputs 0)
set(most_outputs 8)
