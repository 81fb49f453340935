//! An operator with somebody who watches what it says.

use mt_core::analysis::{Draft, Operator, Unfit};
use mt_core::{Plan, Refusal};
use std::cell::Cell;

/// An operator, the first price of its that is none, and how often it was asked for a plan.
pub(super) struct Watched<'a, O> {
    operator: &'a O,
    odd_price: Cell<Option<f64>>,
    plans: Cell<u64>,
}

impl<'a, O> Watched<'a, O> {
    pub(super) fn new(operator: &'a O) -> Self {
        Self { operator, odd_price: Cell::new(None), plans: Cell::new(0) }
    }

    /// How many plans it was asked for.
    pub(super) fn plans(&self) -> u64 {
        self.plans.get()
    }

    /// A price that was below 0 or not a number, if there was one.
    pub(super) fn odd_price(&self) -> Option<f64> {
        self.odd_price.get()
    }
}

impl<const N: usize, O: Operator<N>> Operator<N> for Watched<'_, O> {
    type Site = O::Site;
    type Aux = O::Aux;

    fn name(&self) -> &'static str {
        self.operator.name()
    }
    fn prepare(&self, draft: &Draft<N>, sites: &mut Vec<O::Site>) -> Result<O::Aux, Unfit> {
        self.operator.prepare(draft, sites)
    }
    fn price(&self, draft: &Draft<N>, aux: &O::Aux, site: O::Site) -> Option<f64> {
        let price = self.operator.price(draft, aux, site)?;
        if price.is_nan() || price < 0.0 {
            self.odd_price.set(self.odd_price.get().or(Some(price)));
        }
        Some(price)
    }
    fn plan(&self, draft: &Draft<N>, aux: &O::Aux, site: O::Site, plan: &mut Plan<N>) -> Result<(), Refusal> {
        self.plans.set(self.plans.get() + 1);
        self.operator.plan(draft, aux, site, plan)
    }
    fn alternative(&self, site: O::Site, refusal: Refusal) -> Option<O::Site> {
        self.operator.alternative(site, refusal)
    }
    fn waits(&self, site: O::Site) -> bool {
        self.operator.waits(site)
    }
    fn applied(&self, draft: &Draft<N>, aux: &mut O::Aux, plan: &Plan<N>, again: &mut Vec<O::Site>) {
        self.operator.applied(draft, aux, plan, again);
    }
}
