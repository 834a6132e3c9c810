//! stickslip
