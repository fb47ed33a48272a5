//! Studies: experiments whose numbers stand in docs/, each run by a command of its own.

pub mod deep;
pub mod popping;
