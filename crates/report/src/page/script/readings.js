// The figures of where the tool is: tiles, and a gauge for each joint.

function tiles() {
  const make = (/** @type {string} */ id, /** @type {string} */ name) => {
    const [value, unit_, more] = [el('span', { id }), el('span.u'), el('div.d', { id: `${id}-more` })];
    const tile = el('div.tile', {}, el('div.k', {}, name), el('div.v', {}, value, unit_), more);
    const show_ = (/** @type {string} */ number, /** @type {string} */ unitText, /** @type {string} */ words) => {
      [value.textContent, unit_.textContent, more.textContent] = [number, unitText, words];
    };
    return { tile, show: show_ };
  };
  const here = make('here', `${SCORED[0].toUpperCase()}${SCORED.slice(1)} error here`);
  const mean = make('mean', 'Mean of this case');
  const kappa = make('kappa', '1/κ here');
  const limit = make('limit', 'To the nearest limit');
  onChange(() => {
    const of = current();
    const i = currentPoint();
    const columns = of.columns;
    const map = currentMap();
    const chosen = state.chosen && map ? mapState(map, state.chosen) : null;
    if (!chosen) {
      const more = `total ${fixed(columns.total_mm[i], 2)} mm`;
      here.show(fixed(columns.score_mm[i]), 'mm', more);
      kappa.show(fixed(columns.inverse_condition[i]), '', `limit ${LIMITS.inverse}`);
    } else {
      here.show(
        chosen.isAllowed ? fixed(chosen.score) : '–',
        'mm',
        chosen.isAllowed ? 'chosen in the map' : reasonText(chosen.reason),
      );
      kappa.show('–', '', 'along plans only');
    }
    mean.show(fixed(of.mean), 'mm', `largest ${fixed(of.max)} mm`);
    const joints = currentJoints();
    const gaps = ROWS.map((row, j) => Math.min(joints[j] - row.min, row.max - joints[j]));
    const nearest = gaps.indexOf(Math.min(...gaps));
    limit.show(fixed(gaps[nearest], 1), '°', `joint ${nearest + 1}`);
  });
  return el('div.tiles', {}, here.tile, mean.tile, kappa.tile, limit.tile);
}

function gauges() {
  const rows = ROWS.map((row, j) => {
    const [range, pin, value] = [el('div.rng'), el('div.pin'), el('b', { id: `joint-${j + 1}` })];
    range.style.background = pin.style.background = `var(${JOINT_COLOURS[j]})`;
    const host = el(
      'div.g',
      {},
      el('b', {}, `A${j + 1}`),
      el('span', {}, fixed(row.min, 0)),
      el('div.rail', {}, range, pin),
      el('span', {}, fixed(row.max, 0)),
      value,
    );
    return { host, range, pin, value };
  });
  onChange(({ case: isOther }) => {
    const joints = currentJoints();
    rows.forEach(({ range, pin, value }, j) => {
      pin.style.left = `${clamp(share(j, joints[j]), 0, 100)}%`;
      value.textContent = `${fixed(joints[j], 1)}°`;
      if (!isOther) return;
      const used = current().joints.map((angles) => share(j, angles[j]));
      const [least, most] = used.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [100, 0]);
      range.style.left = `${least}%`;
      range.style.width = `${most - least}%`;
    });
  });
  return card(
    'Joints now',
    'deg; shaded: range over the whole path',
    el('div.gauges', {}, ...rows.map((row) => row.host)),
  );
}
