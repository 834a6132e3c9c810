//! Equations as MathML, which every browser shows without scripts, from a notation of words and blanks.
//!
//! Words are separated by blanks: `J_2` has a subscript, `ω_s^2` a superscript as well, `θ_2'` and
//! `θ_2''` are time derivatives, `a//b` is a fraction of two words; everything else is shown as it is.

use std::fmt::Write;

/// The equation as a displayed `<math>` element.
pub fn equation(notation: &str) -> String {
    let words: String = notation.split_whitespace().map(word).collect();
    format!("<math display=\"block\"><mrow>{words}</mrow></math>")
}

fn word(word: &str) -> String {
    if let Some((numerator, denominator)) = word.split_once("//") {
        return format!(
            "<mfrac>{}{}</mfrac>",
            symbol(numerator),
            symbol(denominator)
        );
    }
    symbol(word)
}

fn symbol(word: &str) -> String {
    let letters = word.trim_end_matches('\'');
    let dots = word.len() - letters.len();
    let (base, superscript) = match letters.split_once('^') {
        Some((base, superscript)) if !base.is_empty() => (base, Some(superscript)),
        _ => (letters, None),
    };
    let mut markup = match base.split_once('_') {
        Some((base, subscript)) if !base.is_empty() => {
            format!("<msub>{}{}</msub>", atom(base), atom(subscript))
        }
        _ => atom(base),
    };
    if dots > 0 {
        let mark = if dots == 1 { "˙" } else { "¨" };
        markup = format!("<mover>{markup}<mo>{mark}</mo></mover>");
    }
    if let Some(superscript) = superscript {
        markup = format!("<msup>{markup}{}</msup>", atom(superscript));
    }
    markup
}

fn atom(text: &str) -> String {
    let tag = if text.chars().all(|c| c.is_ascii_digit() || c == '.') {
        "mn"
    } else if text.chars().all(|c| !c.is_alphanumeric()) {
        "mo"
    } else {
        "mi"
    };
    format!("<{tag}>{}</{tag}>", escape(text))
}

/// Text with the characters that HTML reserves replaced.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other if other.is_control() && other != '\n' => {
                let _ = write!(escaped, "\\u{{{:x}}}", u32::from(other));
            }
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivative_with_subscript() {
        assert_eq!(
            equation("J_2 θ_2'' = − T_f"),
            "<math display=\"block\"><mrow><msub><mi>J</mi><mn>2</mn></msub>\
             <mover><msub><mi>θ</mi><mn>2</mn></msub><mo>¨</mo></mover><mo>=</mo><mo>−</mo>\
             <msub><mi>T</mi><mi>f</mi></msub></mrow></math>"
        );
    }

    #[test]
    fn fraction_and_power() {
        assert_eq!(
            equation("η^2 a//c_1"),
            "<math display=\"block\"><mrow><msup><mi>η</mi><mn>2</mn></msup>\
             <mfrac><mi>a</mi><msub><mi>c</mi><mn>1</mn></msub></mfrac></mrow></math>"
        );
    }

    #[test]
    fn markup_in_text_is_escaped() {
        assert_eq!(escape("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
    }
}
