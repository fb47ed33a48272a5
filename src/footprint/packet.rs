//! Serial form of the packet.
