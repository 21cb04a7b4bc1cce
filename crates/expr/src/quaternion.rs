//! Rotations: unit quaternions (w, x, y, z), as the engine has them.

use hwasp_diff::{Binary, Unary};

use crate::check::Checker;
use crate::error::ExprError;
use crate::exponents::Quantity;
use crate::formulas::{Part, Value};
use crate::functions::{exactly, scalar};
use crate::syntax::Tree;

impl Checker<'_> {
    pub(crate) fn rotation(&mut self, name: &str, arguments: &[Value], trees: &[Tree]) -> Result<Value, ExprError> {
        let q = exactly(4, arguments, 0, trees)?;
        let q = [q[0], q[1], q[2], q[3]];
        match name {
            "rotate" | "unrotate" => {
                let v = exactly(3, arguments, 1, trees)?;
                let q = if name == "rotate" { q } else { self.conjugate(q) };
                let parts = self.rotate(q, [v[0], v[1], v[2]]).to_vec();
                Ok(Value { parts, quantity: arguments[1].quantity })
            }
            "multiply" => {
                let p = exactly(4, arguments, 1, trees)?;
                Ok(Value { parts: self.product(q, [p[0], p[1], p[2], p[3]]).to_vec(), quantity: Quantity::Number })
            }
            "conjugate" => Ok(Value { parts: self.conjugate(q).to_vec(), quantity: Quantity::Number }),
            "turn" => {
                // The angle of the rotation from one to the other: 2·atan2(|vector|, |w|) of their quotient.
                let p = exactly(4, arguments, 1, trees)?;
                let back = self.conjugate(q);
                let [w, x, y, z] = self.product(back, [p[0], p[1], p[2], p[3]]);
                let squares = [x, y, z].map(|part| self.mul(part, part));
                let sum = self.fold(Binary::Add, &squares);
                let (sin, cos) = (self.formulas.unary(Unary::Sqrt, sum), self.formulas.unary(Unary::Abs, w));
                let half = self.atan2(sin, cos);
                let two = self.formulas.constant(2.0);
                Ok(scalar(self.mul(two, half), Quantity::Number))
            }
            angle => Ok(scalar(self.angle(angle, q), Quantity::Number)),
        }
    }

    /// Of rotations about z (yaw), then y (pitch), then x (roll), each in the frame that turned before.
    fn angle(&mut self, which: &str, [w, x, y, z]: [Part; 4]) -> Part {
        let (one, two) = (self.formulas.constant(1.0), self.formulas.constant(2.0));
        if which == "pitch" {
            let (wy, zx) = (self.mul(w, y), self.mul(z, x));
            let difference = self.formulas.binary(Binary::Sub, wy, zx);
            let sin = self.mul(two, difference);
            return self.asin(sin);
        }
        let ([a, b, c, d], [e, f]) = if which == "roll" { ([w, x, y, z], [x, y]) } else { ([w, z, x, y], [y, z]) };
        let (ab, cd, ee, ff) = (self.mul(a, b), self.mul(c, d), self.mul(e, e), self.mul(f, f));
        let sin = self.formulas.binary(Binary::Add, ab, cd);
        let rest = self.formulas.binary(Binary::Add, ee, ff);
        let (sin, rest) = (self.mul(two, sin), self.mul(two, rest));
        let cos = self.formulas.binary(Binary::Sub, one, rest);
        self.atan2(sin, cos)
    }

    fn mul(&mut self, a: Part, b: Part) -> Part {
        self.formulas.binary(Binary::Mul, a, b)
    }

    fn conjugate(&mut self, [w, x, y, z]: [Part; 4]) -> [Part; 4] {
        let [x, y, z] = [x, y, z].map(|part| self.formulas.unary(Unary::Neg, part));
        [w, x, y, z]
    }

    fn product(&mut self, [aw, ax, ay, az]: [Part; 4], [bw, bx, by, bz]: [Part; 4]) -> [Part; 4] {
        let rows = [
            [(aw, bw, false), (ax, bx, true), (ay, by, true), (az, bz, true)],
            [(aw, bx, false), (ax, bw, false), (ay, bz, false), (az, by, true)],
            [(aw, by, false), (ay, bw, false), (az, bx, false), (ax, bz, true)],
            [(aw, bz, false), (az, bw, false), (ax, by, false), (ay, bx, true)],
        ];
        rows.map(|row| {
            let mut sum = None;
            for (a, b, minus) in row {
                let product = self.mul(a, b);
                let op = if minus { Binary::Sub } else { Binary::Add };
                sum = Some(sum.map_or(product, |sum| self.formulas.binary(op, sum, product)));
            }
            sum.expect("a row has four terms")
        })
    }

    /// v + 2w(u × v) + 2u × (u × v), with q = (w, u).
    fn rotate(&mut self, [w, x, y, z]: [Part; 4], v: [Part; 3]) -> [Part; 3] {
        let u = [x, y, z];
        let once = self.cross(u, v);
        let twice = self.cross(u, once);
        let two = self.formulas.constant(2.0);
        std::array::from_fn(|i| {
            let along = self.mul(w, once[i]);
            let sum = self.formulas.binary(Binary::Add, along, twice[i]);
            let off = self.mul(two, sum);
            self.formulas.binary(Binary::Add, v[i], off)
        })
    }

    pub(crate) fn cross(&mut self, a: [Part; 3], b: [Part; 3]) -> [Part; 3] {
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let (forth, back) = (self.mul(a[j], b[k]), self.mul(a[k], b[j]));
            self.formulas.binary(Binary::Sub, forth, back)
        })
    }
}
