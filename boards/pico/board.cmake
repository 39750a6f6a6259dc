# The start-up code of the board's processor.
set(start_up rp2040/start_up.cpp rp2040/second_stage.cpp)

# The processor has no instruction for a division.
set(board_libraries gcc)

# The image starts from the flash by a second stage, and is written to it as a UF2 file.
set(starts_from_uf2 ON)

# OpenOCD's script for the board.
set(openocd_script ${CMAKE_CURRENT_LIST_DIR}/openocd.cfg)
