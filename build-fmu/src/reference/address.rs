//! Addresses (RFC 3986) of files beside a file of an FMU.

/// The file inside the FMU that a relative address in the file `base` means; `None` for an absolute address and for one that
/// leads out.
pub(super) fn resolve(base: &str, address: &str) -> Option<String> {
    let path = address.split(['#', '?']).next()?;
    let scheme = path.split('/').next()?;
    if scheme.contains(':') || path.starts_with('/') {
        return None;
    }
    let mut parts: Vec<String> = base.split('/').map(str::to_owned).collect();
    parts.pop();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            part => parts.push(decoded(part)?),
        }
    }
    Some(parts.join("/"))
}

/// A part of an address without its percent signs.
fn decoded(part: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(part.len());
    let mut rest = part.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let digit = |byte: u8| char::from(byte).to_digit(16);
            let (high, low) = (digit(rest.next()?)?, digit(rest.next()?)?);
            bytes.push(u8::try_from(16 * high + low).ok()?);
        } else {
            bytes.push(byte);
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::FOLDER;

    #[test]
    fn addresses_lead_to_files_of_the_fmu_or_elsewhere() {
        let base = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml";
        let place = |address| resolve(base, address);
        let inside = |name: &str| Some(format!("{FOLDER}/{name}"));
        assert_eq!(place("a.csv"), inside("a.csv"));
        assert_eq!(place("./runs/a%20b.csv#x"), inside("runs/a b.csv"));
        assert_eq!(
            place("../../resources/model.toml").as_deref(),
            Some("resources/model.toml")
        );
        for outside in ["../../../a", "http://a.b/c", "/a", "a%2", "a%zz"] {
            assert_eq!(place(outside), None, "{outside}");
        }
    }
}
