// Verilator's run time wants this where no simulated time exists.
double sc_time_stamp() { return 0; }
