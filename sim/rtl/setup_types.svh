  // One issue slot of a core: a term of a sum. What the fields mean stands in setup_core.sv.
  typedef struct packed {
    logic [3:0] round;  // rounds since the splat's first
    logic a_input;  // first factor: an item of the record,
    logic a_constant;  // the constant,
    logic [7:0] a;  // or this register,
    logic [3:0] a_turn;  // of which splats have several in turn: a mask
    logic b_constant;  // second factor: the constant,
    logic [7:0] b;  // or this register
    logic [3:0] b_turn;
    logic [5:0] constant;
    logic [1:0] lookup;  // 1: reciprocal, 2: root, 3: logarithm
    logic entry;  // the table's entry, not its step times the rest
    logic power;  // the first factor's leading bit's place, not the factor
    logic plain;  // the first factor, not the product
    logic signed [7:0] offset;  // added to the factors' exponents
    logic [1:0] pick;  // not the first factor but the constant where it is negative (1) or is not (2), otherwise the second
    logic by_flag;  // where the flag is not set, the constant is the first factor; beside one as second factor
    logic [1:0] flag;  // the term is the second register, to 31 bits
    logic negated;  // negated before it is aligned
    logic subtracted;  // negated after it is aligned
    logic down;  // rounded down
    logic first;
    logic again;  // from here on in a coarser unit
    logic last;
    logic [1:0] base;  // 0: the largest that a term asks for, 1: the first term's, 2: step alone
    logic signed [6:0] step;  // what is asked for, from the exponent on
    logic addend;  // a constant is added,
    logic [5:0] start;  // this one
    logic normal;  // rounded to a mantissa
    logic [4:0] drop;  // of 31 - drop bits; otherwise left as it is,
    logic [5:0] spare;  // moved left by so much,
    logic extended;  // with what is above it in the exponent's place, and a bit for what is below it
    logic write;
    logic [7:0] place;  // register of the result
    logic [3:0] place_turn;
    logic out;  // what stands at the second factor's register leaves the core and is no factor,
    logic [3:0] word;  // as this word
  } slot_t;

  // A splat as setup takes it: `VolumeSplat` with exponents of 10 bits, as the packet has them.
  typedef struct packed {
    logic [31:0] blue;  // UQ4.28
    logic [31:0] green;
    logic [31:0] red;
    logic signed [9:0] weight_exponent;
    logic signed [31:0] weight;
    logic [29:0] axis_exponents;  // the first axis' are the lowest bits
    logic [287:0] axes;  // x, y, z of the first axis, then of the others
    logic [29:0] centre_exponents;
    logic [95:0] centre;
  } record_t;

  // What the cores get of it: the difference to the eye in two parts, the axes, the weight; see setup_difference.sv.
  localparam int ITEM_BITS = 44;  // {exponent 12, value 32}
  localparam int BEAT_BITS = 88;  // two of them
  localparam int PAIR_BITS = 102;  // two words of a splat, which are results with their exponents
  localparam logic DIRECTS = 1'b0;  // Does the program give directions? Their words leave beside, without exponents.
  localparam int WORD_BITS = PAIR_BITS + (DIRECTS ? 33 : 0);

  // What all cores obey in a cycle and what comes and goes beside it: one group of cores hands it to the
  // next (setup_group.sv). What the fields mean stands in setup_core.sv and setup_memory.sv.
  typedef struct packed {
    logic [22*SLOT_BITS-1:0] slots;  // slot i was issued i cycles ago
    logic unread_a;
    logic unread_b;
    logic [7:0] a_place;
    logic [7:0] b_place;
    logic write;
    logic [7:0] write_place;
    logic [50:0] constant1;
    logic [32:0] picked3;
    logic [17:0] offset3;
    logic [32:0] right4;
    logic [63:0] start14;
    logic [15:0] half19;
    logic [16:0] mask19;
    logic side;  // of the records that are read,
    logic out_side;  // of the results that `out` slots write
    logic load;  // a beat of a record comes
    logic [5:0] load_core;  // to this core, counted from the group's first,
    logic [3:0] load_place;
    logic [BEAT_BITS-1:0] load_beat;
    logic [5:0] drain_core;  // whose results go,
    logic [3:0] drain_place;  // this one
  } step_t;

