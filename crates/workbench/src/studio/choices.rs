//! What a person chose, as it is kept in `studio.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// All that was chosen.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Choices {
    /// Which column is which variable, where a person said so: by variable.
    pub columns: BTreeMap<String, Column>,
    /// What each record is for; records that are not named here are for what their names say.
    pub uses: Vec<Use>,
    /// Effects left out of the catalogue.
    pub without: Vec<String>,
    /// Numbers set by hand, by model and dotted name.
    pub settings: BTreeMap<String, BTreeMap<String, f64>>,
    /// Files that were dropped onto the page.
    pub dropped: Vec<String>,
    /// Which model is believed.
    pub believed: Believed,
    /// What the last diagnosis was asked, and whether it was still running: so a studio that ended in the middle can tell.
    pub asked: Option<Asked>,
    /// What the fits by hand depended on, by their names.
    pub fitted: BTreeMap<String, Value>,
    /// What the page shows; the page's own business.
    pub view: Value,
}

/// Which model is believed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Believed {
    /// The case's.
    #[default]
    Case,
    /// One that was dropped onto the page.
    Dropped(String),
    /// One with numbers set by hand, in the studio's folder.
    Own,
}

/// A column as `[columns]` of a model file has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Its name in the header.
    pub column: String,
    /// Its unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Size of one unit in SI units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
}

/// A record, or a part of one, and what it is for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Use {
    /// Name of the record.
    pub record: String,
    /// From and to [s], in the record's own time; all of it where this is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<[f64; 2]>,
    /// What it is for.
    pub role: Role,
}

/// What a record is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// To learn from.
    Learn,
    /// To judge on.
    HoldOut,
    /// Nothing.
    Off,
}

/// What a diagnosis was asked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// What it depends on: model, records with their parts, columns, catalogue.
    pub inputs: Value,
    /// Whether it came to its end.
    pub is_done: bool,
}

/// A change of what was chosen: what is named replaces what there was.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Change {
    /// See [`Choices::columns`].
    pub columns: Option<BTreeMap<String, Column>>,
    /// See [`Choices::uses`].
    pub uses: Option<Vec<Use>>,
    /// See [`Choices::without`].
    pub without: Option<Vec<String>>,
    /// Numbers of one model: its name, and all that are set by hand.
    pub settings: Option<(String, BTreeMap<String, f64>)>,
    /// See [`Choices::view`].
    pub view: Option<Value>,
    /// Whether a folder that is gone is made anew.
    pub anew: bool,
}

impl Choices {
    /// Takes a change over.
    pub fn change(&mut self, change: Change) {
        if let Some(columns) = change.columns {
            self.columns = columns;
        }
        if let Some(uses) = change.uses {
            self.uses = uses;
        }
        if let Some(without) = change.without {
            self.without = without;
        }
        if let Some((model, settings)) = change.settings {
            self.settings.insert(model, settings);
        }
        if let Some(view) = change.view {
            self.view = view;
        }
    }

    /// The table `[columns]` of a model file that says what was chosen; empty where nothing was.
    pub fn columns_table(&self) -> String {
        if self.columns.is_empty() {
            return String::new();
        }
        let mut table = toml::Table::new();
        for (variable, column) in &self.columns {
            let mut own = toml::Table::new();
            own.insert("column".to_owned(), column.column.clone().into());
            if let Some(unit) = &column.unit {
                own.insert("unit".to_owned(), unit.clone().into());
            }
            if let Some(factor) = column.factor {
                own.insert("factor".to_owned(), factor.into());
            }
            table.insert(variable.clone(), toml::Value::Table(own));
        }
        let mut text = String::from("[columns]\n");
        for (variable, column) in &table {
            text.push_str(&format!("{variable} = {column}\n"));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::rig_columns::RigColumns;

    #[test]
    fn the_table_is_one_of_a_model_file() {
        let mut choices = Choices::default();
        assert_eq!(choices.columns_table(), "");
        choices.columns.insert(
            "theta".to_owned(),
            Column {
                column: "disc \"A\" [deg]".to_owned(),
                unit: Some("deg".to_owned()),
                factor: None,
            },
        );
        let table = choices.columns_table();
        let (columns, rest) = RigColumns::split_off(&table, "model").unwrap();
        assert_ne!(columns, RigColumns::default());
        assert_eq!(rest, "");
    }
}
