set(composition stellaris/composition.cpp)
set(board_definitions EX9000_NO_IMAGE_SLOTS)

# The start-up code of the board's processor.
set(start_up cortex_m/start_up.cpp)

# OpenOCD's script for the board.
set(openocd_script board/ek-lm3s6965.cfg)

# The program that runs images in QEMU, and its option for the file with the settings.
set(run_program ${CMAKE_CURRENT_LIST_DIR}/run)
set(run_memory eeprom)
