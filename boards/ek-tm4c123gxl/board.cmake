set(composition stellaris/composition.cpp)
set(board_definitions EX9000_NO_IMAGE_SLOTS)

# The start-up code of the board's processor.
set(start_up cortex_m/start_up.cpp)

# OpenOCD's script for the board.
set(openocd_script board/ti_ek-tm4c123gxl.cfg)

# The UART of the module's line.
set(EX9000_BUS rs485 CACHE STRING "Line of the module: rs485 (a transceiver on UART1) or usb (the debugger's serial port)")
set_property(CACHE EX9000_BUS PROPERTY STRINGS rs485 usb)
if(EX9000_BUS STREQUAL usb)
  list(APPEND board_definitions EX9000_BUS_ON_USB)
elseif(NOT EX9000_BUS STREQUAL rs485)
  message(FATAL_ERROR "EX9000_BUS: ${EX9000_BUS} is not a line; use rs485 or usb")
endif()
