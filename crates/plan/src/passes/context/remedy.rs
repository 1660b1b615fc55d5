//! Changes of the tool that would clear the part.

use tool_stock::collide::{Section, ToolSolid};

/// Lists, in words, the smallest changes with which a pass `works`, each sufficient by itself: a longer reach, or
/// longer flutes and reach; a slimmer holder; a slimmer shank; and, for `cutter_free`, a smaller cutter with its shank.
pub(crate) fn remedy(solid: &ToolSolid, cutter_free: bool, works: impl Fn(&ToolSolid) -> bool) -> String {
    let from = solid.holder.first().map_or(0.0, |h| h.from);
    let widest = |sections: &[Section]| sections.iter().map(|h| h.radius_from.max(h.radius_to)).fold(0.0, f64::max);
    // As thick everywhere as a holder or shank of this diameter may be.
    let slimmed = |sections: &mut [Section], share: f64| {
        let radius = share * widest(sections);
        for section in sections {
            (section.radius_from, section.radius_to) = (radius, radius);
        }
    };
    // The largest share that works; where the least one does not, no other does.
    let share = |least: u32, works: &dyn Fn(f64) -> bool| {
        let at = |k: u32| 0.1 * f64::from(k);
        works(at(least)).then(|| (least + 1..=9).rev().map(at).find(|share| works(*share)).unwrap_or(at(least)))
    };
    let works_with = |change: &dyn Fn(&mut ToolSolid)| {
        let mut other = solid.clone();
        change(&mut other);
        works(&other)
    };
    let mut changes = Vec::new();
    let lengths = || (1..=16).map(|k| 5.0 * f64::from(k));
    let raised = |sections: &mut [Section], more: f64| {
        for section in sections {
            section.from += more;
            section.to += more;
        }
    };
    let longer = lengths().find(|more| {
        works_with(&|s| {
            if let Some(last) = s.shank.last_mut() {
                last.to += more;
            }
            raised(&mut s.holder, *more);
        })
    });
    if let Some(more) = longer {
        changes.push(format!("a reach of {:.0} mm", from + more));
    }
    // When a longer reach is not enough, the shank collides as well as the holder.
    let longer_flutes = lengths().filter(|_| longer.is_none()).find(|more| {
        works_with(&|s| {
            s.flute_length += more;
            raised(&mut s.shank, *more);
            raised(&mut s.holder, *more);
        })
    });
    if let Some(more) = longer_flutes {
        changes.push(format!("flutes of {:.0} mm with a reach of {:.0} mm", solid.flute_length + more, from + more));
    }
    if let Some(share) = share(2, &|share| works_with(&|s| slimmed(&mut s.holder, share))) {
        changes.push(format!("a holder of at most {:.1} mm diameter", 2.0 * widest(&solid.holder) * share));
    }
    if let Some(share) = share(3, &|share| works_with(&|s| slimmed(&mut s.shank, share))) {
        changes.push(format!("a shank of at most {:.1} mm diameter", 2.0 * widest(&solid.shank) * share));
    }
    let smaller = |share: f64| {
        works_with(&|s| {
            slimmed(&mut s.shank, share);
            s.cutter = s.cutter.scaled(share);
        })
    };
    if let Some(share) = cutter_free.then(|| share(3, &smaller)).flatten() {
        changes.push(format!("a cutter and shank of {:.1} mm diameter", 2.0 * solid.radius() * share));
    }
    match changes.as_slice() {
        [] => {
            "neither a longer reach nor a slimmer holder nor a smaller cutter is enough by itself; use a wider channel"
                .to_owned()
        }
        [change] => format!("{change} is enough"),
        changes => format!("any one of these changes is enough: {}", changes.join("; or ")),
    }
}
