// ex9000-sim: simulated modules on lines that masters can reach.
#include "sim/app/command_line/program.hpp"

int main(int argc, char** argv) { return ex9000::sim::run_program(argc, argv); }
