# Its processor.
set(start_up cortex_m/start_up.cpp)

# What OpenOCD calls the board.
set(openocd_script board/ek-lm3s6965.cfg)
