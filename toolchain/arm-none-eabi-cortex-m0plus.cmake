# Debian's gcc-arm-none-eabi for a Cortex-M0+ without an operating system.
set(CMAKE_SYSTEM_PROCESSOR cortex-m0plus)
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
