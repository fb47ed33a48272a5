// What splat_primitive.sv promises of a tile's end, whatever its units do (formal/idle_units.sv): it comes only when
// nothing of the tile is on its way any more, no packet is taken in its cycle or between two tiles, and the tile's
// window stays as it is in between; so no packet is lost from its tile or drawn into the next. And what lanes write
// goes into a bank that is not being read out. Included in the module where FORMAL is defined (`rtl -- formal`).

  logic started, drew;
  splatline_pkg::window_t window_before;
  logic [LANES-1:0] inside_any, writes_astray;
  logic at_rest;
  initial started = 0;
  always_ff @(posedge clk) begin
    started <= 1;
    drew <= state == DRAW && !rst;
    window_before <= window;
  end

  generate
    for (l = 0; l < LANES; l = l + 1) begin : gen_promises
      assign inside_any[l] = gen_lane[l].inside1 || gen_lane[l].inside2 || gen_lane[l].inside3 || gen_lane[l].inside4 || gen_lane[l].inside5;
      assign writes_astray[l] = (gen_lane[l].transmittance_write || gen_lane[l].colour_write) && gen_lane[l].banks_scanned[side];
      always_comb if (started && !rst) assert (gen_lane[l].banks_scanned == scanned && gen_lane[l].drawn == side);
    end
  endgenerate
  assign at_rest = all_idle && inside_any == 0 && &pixels_idle;

  always_comb begin
    if (!started) assume (rst);
    if (started) assume (!rst);
  end

  always_comb
    if (started) begin
      // A packet goes on to setup, or is of another version.
      if (packet_valid && packet_ready) assert (state == DRAW && (packet_taken || footprint.version != splatline_pkg::PACKET_VERSION));
      // The states are four numbers, of which there are three.
      assert (state == CLEAR || state == IDLE || state == DRAW);
      if (idle) assert (at_rest);
      if (finishes) assert (at_rest && !(packet_valid && packet_ready) && !packet_taken);
      if (state != DRAW) assert (at_rest && !packet_taken);
      if (drew && state == DRAW) assert (window == window_before);
      if (state == CLEAR) assert (scanned == 2'b11 && !side);
      else assert (!scanned[side] && scanned[!side]);
      assert (writes_astray == 0);
    end
