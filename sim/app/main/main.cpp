// ex9000-sim: simulates EX9000 modules on RS-485 lines.
#include "sim/app/main/program.hpp"

int main(int argc, char** argv) { return ex9000::sim::run_program(argc, argv); }
