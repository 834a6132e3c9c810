//! Equations as MathML, which every browser shows without scripts, from a notation of words and blanks.
//!
//! Words are separated by blanks: `J_2` has a subscript, `ω_s^2` a superscript as well, `θ_2'` and
//! `θ_2''` are time derivatives, `^2` raises what is before it, `a//b` is a fraction of two words. `{held while}` and words
//! up to a colon at the beginning are text; everything else is shown as it is.

use std::fmt::Write;

/// The equation as a displayed `<math>` element.
pub fn equation(notation: &str) -> String {
    let mut markup = String::new();
    let mut rest = notation;
    if let Some((condition, equation)) = notation.split_once(": ")
        && condition.split(' ').all(is_word)
    {
        markup.push_str(&text(&format!("{condition}:")));
        rest = equation;
    }
    while let Some((before, after)) = rest.split_once('{') {
        let (sentence, left) = after.split_once('}').unwrap_or((after, ""));
        markup.extend(before.split_whitespace().map(word));
        markup.push_str(&text(sentence));
        rest = left;
    }
    markup.extend(rest.split_whitespace().map(word));
    format!("<math display=\"block\"><mrow>{markup}</mrow></math>")
}

fn is_word(text: &str) -> bool {
    text.len() > 1 && text.chars().all(char::is_alphabetic)
}

/// Words between symbols, kept apart from them by spaces that browsers do not drop.
fn text(sentence: &str) -> String {
    format!("<mtext>\u{a0}{}\u{a0}</mtext>", escape(sentence))
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
        Some((base, superscript)) => (base, Some(superscript)),
        None => (letters, None),
    };
    let mut markup = match base.split_once('_') {
        Some((base, subscript)) if !base.is_empty() => {
            format!("<msub>{}{}</msub>", atom(base), atom(subscript))
        }
        _ if base.is_empty() => "<mrow></mrow>".to_owned(),
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
    fn a_power_of_what_stands_in_brackets() {
        assert!(equation("( a ) ^2").contains("<mo>)</mo><msup><mrow></mrow><mn>2</mn></msup>"));
    }

    #[test]
    fn words_are_text_and_keep_their_blanks() {
        assert_eq!(
            equation("sticks from sliding: v = 0 , {held while} u"),
            "<math display=\"block\"><mrow><mtext>\u{a0}sticks from sliding:\u{a0}</mtext><mi>v</mi><mo>=</mo><mn>0</mn><mo>,</mo>\
             <mtext>\u{a0}held while\u{a0}</mtext><mi>u</mi></mrow></math>"
        );
    }

    #[test]
    fn markup_in_text_is_escaped() {
        assert_eq!(escape("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
    }
}
