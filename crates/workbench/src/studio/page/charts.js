// Plots, by uPlot: curves over a coordinate, clouds of samples, phases that are shaded, ranges that are chosen with the mouse.

const HEIGHT = 230;

/** A colour of the page. */
export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Numbers as uPlot has them: a hole is null. */
export function holes(values) {
  return Array.from(values, (value) => (Number.isFinite(value) ? value : null));
}

function axis(label) {
  return {
    label, labelSize: 22, size: 46, labelGap: 0, font: "12px system-ui", labelFont: "12px system-ui", stroke: colour("ink"),
    grid: { stroke: colour("grid"), width: 1 }, ticks: { stroke: colour("grid"), width: 1 },
  };
}

/** A plot that keeps its place and width, and is drawn anew where its shape changes. */
export class Plot {
  /**
   * `x` labels the coordinate, `y` the values; each of `series` has `label`, `colour`, `points` for a cloud, and `right` for an
   * axis of its own. `chosen` hears
   * the range that is drawn with the mouse, or null; without it drawing zooms.
   */
  constructor(place, { x, y, series, chosen, height = HEIGHT, name }) {
    this.place = place;
    this.options = { x, y, series, chosen, height };
    this.shaded = null;
    this.data = null;
    this.place.setAttribute("role", "group");
    this.place.setAttribute("aria-label", name);
    new ResizeObserver(() => this.fit()).observe(place);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.make());
  }

  /** Other labels and series. */
  shape(options) {
    const before = JSON.stringify(this.options);
    Object.assign(this.options, options);
    if (JSON.stringify(this.options) !== before) {
      this.make();
    }
  }

  /** Shows these columns; `shaded` has pairs of the coordinate. */
  show(data, shaded = null) {
    const isOther = this.data === null || this.data.length !== data.length
      || this.data[0].length !== data[0].length || this.data[0][0] !== data[0][0];
    this.data = data;
    this.shaded = shaded;
    if (this.plot === undefined) {
      this.make();
    } else {
      // A zoom survives what moves with a slider.
      this.plot.setData(data, isOther || !this.isZoomed());
    }
  }

  isZoomed() {
    const { min, max } = this.plot.scales.x;
    const all = this.plot.data[0];
    return all.length > 0 && (min > all[0] || max < all[all.length - 1]);
  }

  fit() {
    if (this.plot !== undefined && this.place.clientWidth > 0) {
      this.plot.setSize({ width: this.place.clientWidth, height: this.options.height });
    } else if (this.data !== null) {
      this.make();
    }
  }

  make() {
    this.plot?.destroy();
    this.plot = undefined;
    if (this.data === null || this.place.clientWidth === 0) {
      return;
    }
    const { x, y, series, chosen, height } = this.options;
    const curves = series.map((one) => ({
      label: one.label,
      scale: one.right ? "right" : "y",
      stroke: colour(one.colour),
      width: one.points ? 0 : 1,
      value: (_, value) => (value === null || value === undefined ? "–" : value.toPrecision(5)),
      ...(one.points
        ? { paths: () => null, points: { show: true, size: one.size ?? 2.5, space: 0, width: 0, fill: colour(one.colour) } }
        : { points: { show: false } }),
    }));
    const shade = (plot) => {
      const { left, top, width, height } = plot.bbox;
      plot.ctx.save();
      plot.ctx.beginPath();
      plot.ctx.rect(left, top, width, height);
      plot.ctx.clip();
      plot.ctx.fillStyle = colour("stuck");
      for (const [from, to] of this.shaded ?? []) {
        const begin = plot.valToPos(from, "x", true);
        plot.ctx.fillRect(begin, top, Math.max(1, plot.valToPos(to, "x", true) - begin), height);
      }
      plot.ctx.restore();
    };
    const pick = (plot) => {
      const { left, width } = plot.select;
      if (width > 3) {
        chosen([plot.posToVal(left, "x"), plot.posToVal(left + width, "x")]);
      } else {
        chosen(null);
      }
    };
    this.plot = new uPlot({
      width: this.place.clientWidth,
      height,
      scales: { x: { time: false } },
      axes: [
        { ...axis(x), size: 34 },
        { ...axis(y), size: 62 },
        ...series.filter((one) => one.right).slice(0, 1).map((one) => (
          { ...axis(one.label), size: 62, side: 1, scale: "right", grid: { show: false } })),
      ],
      legend: { markers: { width: 2, stroke: (_, at) => (at === 0 ? null : colour(series[at - 1].colour)) } },
      series: [{ label: x, value: (_, value) => (value === null || value === undefined ? "–" : value.toPrecision(5)) }, ...curves],
      cursor: { drag: { x: true, y: false, setScale: chosen === undefined } },
      hooks: { drawClear: [shade], ...(chosen === undefined ? {} : { setSelect: [pick] }) },
    }, this.data, this.place);
  }
}

/** The phases in which `flags` is 1, as pairs of the coordinate. */
export function phases(coordinate, flags) {
  const found = [];
  let begin = null;
  flags.forEach((flag, at) => {
    if (flag === 1 && begin === null) {
      begin = coordinate[at];
    } else if (flag !== 1 && begin !== null) {
      found.push([begin, coordinate[at]]);
      begin = null;
    }
  });
  if (begin !== null) {
    found.push([begin, coordinate[coordinate.length - 1]]);
  }
  return found;
}
