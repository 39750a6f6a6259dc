# The start-up code of the board's processor.
set(start_up cortex_m/start_up.cpp)

# OpenOCD's script for the board.
set(openocd_script board/ek-lm3s6965.cfg)

# Runs images in QEMU.
set(run_program ${CMAKE_CURRENT_LIST_DIR}/run)
set(run_memory eeprom)
