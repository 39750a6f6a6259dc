# What OpenOCD calls the board.
set(openocd_script board/ek-lm3s6965.cfg)
