set(composition rp2040/composition.cpp)

# The start-up code of the board's processor.
set(start_up rp2040/start_up.cpp rp2040/second_stage.cpp)

# Every image contains the loader.
set(loader rp2040/loader)

# The images need libgcc, because the processor has no instruction for a division.
set(board_libraries gcc)

# The build writes checksums of the second stage and of the image, and also writes each image as a UF2 file, which users copy to the
# drive of the boot ROM.
set(starts_from_uf2 ON)

set(openocd_script ${CMAKE_CURRENT_LIST_DIR}/openocd.cfg)

set(EX9000_MEMORY flash CACHE STRING "Memory of the settings: flash (the end of the flash) or eeprom (an AT24C64 on I2C)")
set_property(CACHE EX9000_MEMORY PROPERTY STRINGS flash eeprom)
if(EX9000_MEMORY STREQUAL eeprom)
  set(board_definitions EX9000_SETTINGS_IN_EEPROM)
elseif(NOT EX9000_MEMORY STREQUAL flash)
  message(FATAL_ERROR "EX9000_MEMORY: ${EX9000_MEMORY} is not a value of this option; use flash or eeprom")
endif()

# Runs images in rp2040js.
set(run_program ${CMAKE_CURRENT_LIST_DIR}/run)
set(run_memory ${EX9000_MEMORY})
