//! From text to a program: a recursive descent over sums, products, powers and calls.

use super::coordinate::Quantity;
use super::program::{Program, SITES, Site};
use super::{Dimension, ExpressionError, Table, bounds, dimension};
use crate::parameter::Range;
use operations::Operation;

/// Longest text of an equation, in characters.
const LONGEST: usize = 1000;
/// Most operations of an equation.
const MOST_OPERATIONS: usize = 200;
/// Deepest nesting of brackets, powers and signs.
const DEEPEST: usize = 40;
/// Largest whole exponent.
const HIGHEST_POWER: f64 = 64.0;

/// Functions that equations may call.
pub const FUNCTIONS: [&str; 11] = [
    "sin", "cos", "exp", "log", "sqrt", "abs", "sign", "pow", "tanh", "min", "max",
];

/// What an equation may name.
pub struct Names<'a> {
    /// Parameters: name, dimension, range.
    pub parameters: &'a [(&'a str, Dimension, Range)],
    /// Coordinates of the port.
    pub coordinates: &'a [Quantity],
    /// Tables that can be called.
    pub tables: &'a [Table],
    /// Dimension that the port takes, and its unit's name.
    pub result: (Dimension, &'a str),
}

impl Names<'_> {
    /// The coordinate at this place.
    pub(super) fn coordinate(&self, place: usize) -> Option<&Quantity> {
        self.coordinates.iter().find(|own| own.place == place)
    }
}

/// Reads an equation and checks units, poles and kinks through all of it.
///
/// # Errors
/// The first thing that is wrong, with its column.
pub fn parse(text: &str, names: &Names<'_>) -> Result<Program, ExpressionError> {
    let length = text.chars().count();
    if length > LONGEST {
        let reason = format!("an equation has at most {LONGEST} characters, not {length}");
        return Err(ExpressionError::new(LONGEST + 1, reason));
    }
    let mut parser = Parser {
        text: text.chars().collect(),
        at: 0,
        depth: 0,
        names,
        program: Program {
            operations: Vec::new(),
            columns: Vec::new(),
            constant: Vec::new(),
            varying: Vec::new(),
            tables: names.tables.to_vec(),
            sites: Vec::new(),
            dimensions: Vec::new(),
        },
    };
    let root = parser.sum()?;
    parser.skip_spaces();
    if let Some(next) = parser.text.get(parser.at) {
        let reason = format!("\"{next}\" is one too many; an operator or the end is expected");
        return Err(parser.error(reason));
    }
    let mut program = parser.program;
    // The value of the whole is that of the last operation.
    debug_assert_eq!(root + 1, program.operations.len());
    for (place, (name, ..)) in names.parameters.iter().enumerate() {
        if !program.operations.contains(&Operation::Parameter(place)) {
            let reason = format!("the equation does not use the parameter \"{name}\"");
            return Err(ExpressionError::new(1, reason));
        }
    }
    for (place, table) in names.tables.iter().enumerate() {
        let calls = |operation: &Operation| matches!(operation, Operation::Table(_, called, _) if *called == place);
        if !program.operations.iter().any(calls) {
            let reason = format!("the equation does not use the table \"{}\"", table.name);
            return Err(ExpressionError::new(1, reason));
        }
    }
    let dimensions = dimension::check(&program, names)?;
    let (wanted, unit) = names.result;
    if dimensions[root] != wanted {
        let reason = format!(
            "the equation gives a quantity in {}, but the port takes {unit}",
            dimensions[root]
        );
        return Err(ExpressionError::new(1, reason));
    }
    program.dimensions = dimensions;
    bounds::check(&program, names)?;
    check_jumps(&program, names)?;
    Ok(program)
}

/// Refuses jumps over what a torque changes at once: the motion would stick there, and only a contact can.
fn check_jumps(program: &Program, names: &Names<'_>) -> Result<(), ExpressionError> {
    let is_rate = |place: usize| names.coordinate(place).is_some_and(|own| own.is_rate);
    // Whether each operation depends on a rate. Each is looked at once: powers of powers reach what they depend on by more ways
    // than anybody can go.
    let mut depends: Vec<bool> = Vec::with_capacity(program.operations.len());
    for (operation, &column) in program.operations.iter().zip(&program.columns) {
        if let Operation::Sign(argument, _) = operation
            && depends[*argument]
        {
            let reason = "sign jumps where its argument passes zero, and a motion that depends on a velocity or a current \
                          would stay there without an event; write velocity*abs(velocity) or tanh(velocity/width), or dry friction \
                          that sticks exactly: [bearing_friction] of a rig, the coordinate direction of a small plant";
            return Err(ExpressionError::new(column, reason));
        }
        let is_one = matches!(operation, Operation::Coordinate(place) if is_rate(*place));
        depends.push(is_one || operation.operands().any(|operand| depends[operand]));
    }
    Ok(())
}

struct Parser<'a> {
    text: Vec<char>,
    at: usize,
    depth: usize,
    names: &'a Names<'a>,
    program: Program,
}

impl Parser<'_> {
    #[cold]
    fn error(&self, reason: impl Into<String>) -> ExpressionError {
        ExpressionError::new(self.at + 1, reason)
    }

    fn skip_spaces(&mut self) {
        while self.text.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
    }

    /// Steps over `wanted` if it comes next.
    fn takes(&mut self, wanted: char) -> bool {
        self.skip_spaces();
        let found = self.text.get(self.at) == Some(&wanted);
        self.at += usize::from(found);
        found
    }

    fn expects(&mut self, wanted: char) -> Result<(), ExpressionError> {
        if self.takes(wanted) {
            return Ok(());
        }
        let found = match self.text.get(self.at) {
            Some(found) => format!("\"{found}\""),
            None => "the end".to_owned(),
        };
        Err(self.error(format!("\"{wanted}\" is expected, not {found}")))
    }

    fn add(&mut self, operation: Operation, column: usize) -> Result<usize, ExpressionError> {
        let operations = &self.program.operations;
        if operations.len() == MOST_OPERATIONS {
            let reason = format!("an equation has at most {MOST_OPERATIONS} operations");
            return Err(ExpressionError::new(column, reason));
        }
        self.program.add(operation, column);
        Ok(self.program.operations.len() - 1)
    }

    fn site(
        &mut self,
        site: impl FnOnce(usize) -> Site,
        column: usize,
    ) -> Result<usize, ExpressionError> {
        if self.program.sites.len() == SITES {
            let reason = format!("the effects of a rig have at most {SITES} kinks together");
            return Err(ExpressionError::new(column, reason));
        }
        self.program.sites.push(site(self.program.operations.len()));
        Ok(self.program.sites.len() - 1)
    }

    fn sum(&mut self) -> Result<usize, ExpressionError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(format!("an equation is at most {DEEPEST} brackets deep")));
        }
        let mut left = self.product()?;
        loop {
            let column = self.at + 1;
            let add = self.takes('+');
            if !add && !self.takes('-') {
                self.depth -= 1;
                return Ok(left);
            }
            let right = self.product()?;
            let operation = if add {
                Operation::Add(left, right)
            } else {
                Operation::Subtract(left, right)
            };
            left = self.add(operation, column)?;
        }
    }

    fn product(&mut self) -> Result<usize, ExpressionError> {
        let mut left = self.signed()?;
        loop {
            self.skip_spaces();
            let column = self.at + 1;
            let times = self.takes('*');
            if times && self.text.get(self.at) == Some(&'*') {
                return Err(self.error("write a power as x^2 or pow(x, 2)"));
            }
            if !times && !self.takes('/') {
                return Ok(left);
            }
            let right = self.signed()?;
            let operation = if times {
                Operation::Multiply(left, right)
            } else {
                Operation::Divide(left, right)
            };
            left = self.add(operation, column)?;
        }
    }

    fn signed(&mut self) -> Result<usize, ExpressionError> {
        self.skip_spaces();
        let column = self.at + 1;
        let mut minus = false;
        while self.takes('-') {
            minus = !minus;
        }
        let value = self.raised()?;
        if minus {
            self.add(Operation::Negate(value), column)
        } else {
            Ok(value)
        }
    }

    fn raised(&mut self) -> Result<usize, ExpressionError> {
        let base = self.atom()?;
        self.skip_spaces();
        let column = self.at + 1;
        if !self.takes('^') {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(format!("an equation is at most {DEEPEST} powers deep")));
        }
        let exponent = self.signed()?;
        self.depth -= 1;
        self.power(base, exponent, column)
    }

    fn power(
        &mut self,
        base: usize,
        exponent: usize,
        column: usize,
    ) -> Result<usize, ExpressionError> {
        let literal = match self.program.operations[exponent] {
            Operation::Number(value) => Some(value),
            Operation::Negate(node) => match self.program.operations[node] {
                Operation::Number(value) => Some(-value),
                _ => None,
            },
            _ => None,
        };
        match literal.filter(|value| value.fract() == 0.0) {
            Some(value) if value.abs() > HIGHEST_POWER => {
                let reason = format!("a whole exponent is at most {HIGHEST_POWER} in size");
                Err(ExpressionError::new(column, reason))
            }
            Some(value) if value < 0.0 => {
                let power = self.whole_power(base, -value as u32, column)?;
                let one = self.add(Operation::Number(1.0), column)?;
                self.add(Operation::Divide(one, power), column)
            }
            Some(value) => self.whole_power(base, value as u32, column),
            None => self.add(Operation::RealPower(base, exponent), column),
        }
    }

    fn whole_power(
        &mut self,
        base: usize,
        exponent: u32,
        column: usize,
    ) -> Result<usize, ExpressionError> {
        match exponent {
            0 => self.add(Operation::Number(1.0), column),
            1 => {
                let one = self.add(Operation::Number(1.0), column)?;
                self.add(Operation::Multiply(base, one), column)
            }
            2..=4 => self.add(Operation::Power(base, exponent), column),
            _ => {
                let half = self.whole_power(base, exponent / 2, column)?;
                let square = self.add(Operation::Power(half, 2), column)?;
                if exponent.is_multiple_of(2) {
                    Ok(square)
                } else {
                    self.add(Operation::Multiply(square, base), column)
                }
            }
        }
    }

    fn atom(&mut self) -> Result<usize, ExpressionError> {
        self.skip_spaces();
        let column = self.at + 1;
        if self.takes('(') {
            let inside = self.sum()?;
            self.expects(')')?;
            return Ok(inside);
        }
        match self.text.get(self.at) {
            Some(c) if c.is_ascii_digit() || *c == '.' => {
                let value = self.number()?;
                self.add(Operation::Number(value), column)
            }
            Some(c) if c.is_alphabetic() || *c == '_' => {
                let start = self.at;
                while self
                    .text
                    .get(self.at)
                    .is_some_and(|c| c.is_alphanumeric() || *c == '_')
                {
                    self.at += 1;
                }
                let name: String = self.text[start..self.at].iter().collect();
                if self.takes('(') {
                    self.call(&name, column)
                } else {
                    self.named(&name, column)
                }
            }
            Some(c) => Err(self.error(format!("\"{c}\" begins no number, name or bracket"))),
            None => {
                Err(self.error("the equation ends where a number, a name or a bracket is expected"))
            }
        }
    }

    fn number(&mut self) -> Result<f64, ExpressionError> {
        let start = self.at;
        let digit = |c: Option<&char>| c.is_some_and(|c| c.is_ascii_digit() || *c == '.');
        while digit(self.text.get(self.at)) {
            self.at += 1;
        }
        if matches!(self.text.get(self.at), Some('e' | 'E')) {
            let signed = usize::from(matches!(self.text.get(self.at + 1), Some('+' | '-')));
            if digit(self.text.get(self.at + 1 + signed)) {
                self.at += 1 + signed;
                while digit(self.text.get(self.at)) {
                    self.at += 1;
                }
            }
        }
        let text: String = self.text[start..self.at].iter().collect();
        let value: Option<f64> = text.parse().ok().filter(|value: &f64| value.is_finite());
        value.ok_or_else(|| {
            ExpressionError::new(start + 1, format!("\"{text}\" is no finite number"))
        })
    }

    fn named(&mut self, name: &str, column: usize) -> Result<usize, ExpressionError> {
        let names = self.names;
        if let Some(place) = names
            .parameters
            .iter()
            .position(|(known, ..)| *known == name)
        {
            return self.add(Operation::Parameter(place), column);
        }
        if let Some(coordinate) = names.coordinates.iter().find(|known| known.name == name) {
            return self.add(Operation::Coordinate(coordinate.place), column);
        }
        if name == "pi" {
            return self.add(Operation::Number(std::f64::consts::PI), column);
        }
        let list = |names: Vec<&str>| match names.is_empty() {
            true => "none".to_owned(),
            false => names.join(", "),
        };
        let reason = format!(
            "nothing is called \"{name}\"; coordinates of this port: {}; parameters: {}; functions: {}",
            list(names.coordinates.iter().map(|c| c.name).collect()),
            list(names.parameters.iter().map(|(name, ..)| *name).collect()),
            FUNCTIONS.join(", ")
        );
        Err(ExpressionError::new(column, reason))
    }

    fn call(&mut self, name: &str, column: usize) -> Result<usize, ExpressionError> {
        let table = self
            .names
            .tables
            .iter()
            .position(|table| table.name == name);
        if table.is_none() && !FUNCTIONS.contains(&name) {
            let tables = self.names.tables.iter().map(|table| table.name.as_str());
            let known: Vec<&str> = FUNCTIONS.into_iter().chain(tables).collect();
            let reason = format!(
                "there is no function \"{name}\"; there are {}",
                known.join(", ")
            );
            return Err(ExpressionError::new(column, reason));
        }
        let first = self.sum()?;
        let second = if table.is_none() && matches!(name, "pow" | "min" | "max") {
            self.expects(',')?;
            Some(self.sum()?)
        } else {
            None
        };
        self.expects(')')?;
        if let Some(table) = table {
            let site = self.site(|node| Site::Pieces { node, table }, column)?;
            return self.add(Operation::Table(first, table, site), column);
        }
        let operation = match (name, second) {
            ("sin", _) => Operation::Sine(first),
            ("cos", _) => Operation::Cosine(first),
            ("exp", _) => Operation::Exponential(first),
            ("log", _) => Operation::Logarithm(first),
            ("sqrt", _) => Operation::SquareRoot(first),
            ("tanh", _) => Operation::HyperbolicTangent(first),
            ("pow", Some(exponent)) => return self.power(first, exponent, column),
            (_, second) => {
                let site = self.site(|node| Site::Sides { node }, column)?;
                match (name, second) {
                    ("abs", _) => Operation::Absolute(first, site),
                    ("min", Some(second)) => Operation::Minimum(first, second, site),
                    ("max", Some(second)) => Operation::Maximum(first, second, site),
                    _ => Operation::Sign(first, site),
                }
            }
        };
        self.add(operation, column)
    }
}
