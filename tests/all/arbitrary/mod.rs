//! Any value of any public input of the kernel, drawn from bytes: shared by the property tests and the fuzz targets.
//!
//! A value costs one byte that picks a pattern and up to eight bytes of payload. Patterns are weighted towards where
//! integer arithmetic breaks: the ends of the type, powers of two and their neighbours, small numbers. When the bytes
//! run out, zeros follow, so that every byte string is a complete input and short ones stay readable.

#![allow(dead_code)] // Each test and fuzz target uses a part of it.

use fixed::types::{I2F30, I8F24, I10F54, I32F32, U4F28};
use splatline::footprint::depth::KEY_BITS;
use splatline::footprint::packet::{Packet, VERSION};
use splatline::footprint::{Conic, Footprint, Ldl};
use splatline::format::{Rounding, RuntimeWidths, WIDTH_RANGES, Widths};
use splatline::kernel::Kernel;
use splatline::math::{Extended, SoftFloat};
use splatline::raster::Window;
use splatline::rules::{Compositing, Cutoff, Rules};
use splatline::splat::{Axis, FixedPosition, VolumeSplat};
use splatline::view::{Eye, Projection, RatioLimits, Translation, View};

/// Bytes that are read as values.
pub struct Source<'a> {
    bytes: &'a [u8],
}

impl<'a> Source<'a> {
    /// Reads `bytes` from their beginning.
    pub fn new(bytes: &'a [u8]) -> Self {
        Source { bytes }
    }

    /// The next byte; 0 after the end.
    pub fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.bytes.split_first() else {
            return 0;
        };
        self.bytes = rest;
        *first
    }

    fn raw(&mut self) -> u64 {
        u64::from_le_bytes([(); 8].map(|()| self.byte()))
    }

    /// 64 bits, of which the low `width` are a value of interest.
    pub fn bits(&mut self, width: u32) -> u64 {
        let power = |exponent: u8| 1u64 << (u32::from(exponent) % width);
        match self.byte() % 8 {
            0 => 0,
            1 => power(self.byte()),
            2 => power(self.byte()).wrapping_sub(1),
            3 => power(self.byte()).wrapping_neg(),
            4 => u64::from(self.byte()),
            5 => (1u64 << (width - 1)).wrapping_sub(u64::from(self.byte() % 4)),
            6 => self.raw() >> (self.byte() % 64),
            _ => self.raw(),
        }
    }

    /// Any 64-bit integer.
    pub fn i64(&mut self) -> i64 {
        self.bits(64) as i64
    }

    /// Any 32-bit integer.
    pub fn i32(&mut self) -> i32 {
        self.bits(32) as i32
    }

    /// Any unsigned 32-bit integer.
    pub fn u32(&mut self) -> u32 {
        self.bits(32) as u32
    }

    /// Any unsigned 16-bit integer.
    pub fn u16(&mut self) -> u16 {
        self.bits(16) as u16
    }

    /// Any truth value.
    pub fn bool(&mut self) -> bool {
        self.byte() & 1 != 0
    }

    /// An exponent: mostly near 0, where numbers meet, sometimes anything.
    fn exponent(&mut self) -> i32 {
        match self.byte() % 4 {
            0 => self.i32(),
            _ => i32::from(self.byte() as i8) / 2,
        }
    }

    /// Any mantissa and exponent.
    pub fn scaled(&mut self) -> SoftFloat {
        SoftFloat {
            mantissa: self.i32(),
            exponent: self.exponent(),
        }
    }

    /// Any wide mantissa and exponent.
    pub fn extended(&mut self) -> Extended {
        Extended {
            value: self.i64(),
            exponent: self.exponent(),
        }
    }

    /// Any widths that a design may have.
    pub fn widths(&mut self) -> Widths {
        let numbers = WIDTH_RANGES.map(|(_, low, high)| low + self.byte() % (high - low + 1));
        let rounding = match self.byte() % 3 {
            0 => Rounding::Nearest,
            1 => Rounding::NearestEven,
            _ => Rounding::Truncate,
        };
        let ranges = Widths::from_numbers(numbers, rounding).ranges();
        let mut of_all = ranges.iter();
        let numbers =
            numbers.map(|number| of_all.next().map_or(number, |(.., high)| number.min(*high)));
        Widths::from_numbers(numbers, rounding)
    }

    /// Any run-time design.
    pub fn design(&mut self) -> RuntimeWidths {
        RuntimeWidths::new(self.widths()).expect("the widths are within their ranges")
    }

    /// Any camera.
    pub fn view(&mut self) -> View {
        View {
            rotation: [(); 3].map(|()| [(); 3].map(|()| I2F30::from_bits(self.i32()))),
            pose: Eye {
                position: [(); 3].map(|()| self.i64()),
                exponent: self.exponent(),
                rotation_rest: [(); 3].map(|()| [(); 3].map(|()| self.i32())),
            },
            focal: [(); 2].map(|()| self.scaled()),
            principal: [(); 2].map(|()| I32F32::from_bits(self.i64())),
            near: self.extended(),
            far: self.extended(),
            viewport: [self.u16(), self.u16()],
            projection: if self.bool() {
                Projection::Perspective
            } else {
                Projection::Orthographic
            },
            limits: RatioLimits {
                low: [(); 2].map(|()| I32F32::from_bits(self.i64())),
                high: [(); 2].map(|()| I32F32::from_bits(self.i64())),
            },
        }
    }

    /// A camera that sees what lies before it, with any focal length: most splats get past the culling.
    pub fn sound_view(&mut self) -> View {
        let axis = |row: usize| {
            [0, 1, 2].map(|column| I2F30::from_bits(if row == column { 1 << 30 } else { 0 }))
        };
        let mut view = self.view();
        view.rotation = [axis(0), axis(1), axis(2)];
        view.pose = Eye {
            position: [0, 0, -1 << 50],
            exponent: -50,
            rotation_rest: [[0; 3]; 3],
        };
        view.near = Extended {
            value: 1,
            exponent: -14,
        };
        view.far = Extended::MAX;
        view.focal = [(); 2].map(|()| SoftFloat {
            mantissa: 1 << 30,
            exponent: i32::from(self.byte() % 16) - 32,
        });
        view.principal = [I32F32::from_num(40); 2];
        view.viewport = [128, 96];
        view
    }

    /// The same camera for centres in fixed point, standing anywhere.
    pub fn fixed_view(&mut self, view: View) -> View<Translation> {
        View {
            rotation: view.rotation,
            pose: Translation([(); 3].map(|()| I10F54::from_bits(self.i64()))),
            focal: view.focal,
            principal: view.principal,
            near: view.near,
            far: view.far,
            viewport: view.viewport,
            projection: view.projection,
            limits: view.limits,
        }
    }

    /// The same splat with any centre in fixed point.
    pub fn fixed_splat(&mut self, splat: VolumeSplat) -> VolumeSplat<FixedPosition> {
        VolumeSplat {
            centre: [(); 3].map(|()| I8F24::from_bits(self.i32())),
            axes: splat.axes,
            weight: splat.weight,
            colour: splat.colour,
        }
    }

    /// Any volume splat.
    pub fn volume_splat(&mut self) -> VolumeSplat {
        VolumeSplat {
            centre: [(); 3].map(|()| self.scaled()),
            axes: [(); 3].map(|()| Axis {
                mantissa: [(); 3].map(|()| self.i32()),
                exponent: self.exponent(),
            }),
            weight: self.scaled(),
            colour: [(); 3].map(|()| U4F28::from_bits(self.u32())),
        }
    }

    /// A splat that a sound camera is likely to see: of any shape, but of a size and an opacity that leave a trace.
    pub fn visible_splat(&mut self) -> VolumeSplat {
        let mut splat = self.volume_splat();
        splat.centre = [(); 3].map(|()| SoftFloat {
            mantissa: self.i32() >> 10,
            exponent: -24,
        });
        for axis in &mut splat.axes {
            axis.exponent = -28 - i32::from(self.byte() % 16);
        }
        splat.weight = SoftFloat {
            mantissa: self.i32() | 1 << 29,
            exponent: -30,
        };
        splat
    }

    /// Any rules.
    pub fn rules(&mut self) -> Rules {
        match self.byte() % 4 {
            0 => Rules::EWA,
            1 => Rules::GAUSSIAN_3D,
            _ => Rules {
                normalised: self.bool(),
                low_pass: self.scaled(),
                compensated: self.bool(),
                spacing: self.scaled(),
                kernel: Kernel::ALL[usize::from(self.byte() % 4)],
                cutoff: if self.bool() {
                    Cutoff::Radial(self.u32())
                } else {
                    Cutoff::Opacity
                },
                alpha_max: self.u32(),
                alpha_min: self.i64() as u64,
                minimum_transmittance: self.i64() as u64,
                omit_finishing: self.bool(),
                clamp_jacobian: self.bool(),
                table_range: self.bits(8) as u8,
            },
        }
    }

    /// Any order of compositing.
    pub fn compositing(&mut self) -> Compositing {
        match self.byte() % 3 {
            0 => Compositing::FrontToBack,
            1 => Compositing::BackToFront,
            _ => Compositing::XRay,
        }
    }

    /// Any footprint, also those that setup never makes.
    pub fn footprint(&mut self) -> Footprint {
        Footprint {
            depth: self.i64() as u64 >> (64 - KEY_BITS),
            centre: [(); 2].map(|()| self.i64()),
            first: [self.edge(), self.edge()],
            end: [self.edge(), self.edge()],
            ldl: Ldl {
                horizontal: self.scaled(),
                squared_width: self.scaled(),
                shear: self.scaled(),
                vertical: self.scaled(),
            },
            conic: Conic {
                mantissa: [(); 3].map(|()| self.i32()),
                exponent: self.exponent(),
            },
            cutoff: self.u32(),
            opacity: self.u32(),
            colour: [(); 3].map(|()| self.u32()),
        }
    }

    /// Any packet, three quarters of them of the version that is understood.
    pub fn packet(&mut self) -> Packet {
        let mut packet = Packet::default();
        packet.fill_with(|| self.raw() as u32);
        if !self.byte().is_multiple_of(4) {
            packet[0] = packet[0] & !15 | VERSION;
        }
        packet
    }

    /// A column or row: mostly near the windows of the tests, sometimes anything.
    fn edge(&mut self) -> u16 {
        match self.byte() % 4 {
            0 => self.u16(),
            _ => self.byte().into(),
        }
    }

    /// Any window of at most 96 x 96 pixels anywhere on the screen, empty and inverted ones included.
    pub fn window(&mut self) -> Window {
        let first = [self.edge(), self.edge()];
        let last = first.map(|edge| match self.byte() % 8 {
            0 => edge.saturating_sub(self.byte().into()),
            _ => edge.saturating_add(u16::from(self.byte() % 97)),
        });
        Window { first, end: last }
    }
}
