// CMake builds the precompiled header of all tests with this file, which has no other content.
