// A plot: two canvases, one for what is shown and one for what moves over it, a tip at the pointer, and zoom by wheel, drag, buttons and
// keys.

import { canvasOf, contextOf, el } from './dom.js';
import { clamp, ticks } from './scale.js';
import { onTheme, themeColour } from './theme.js';
/** @import { Axis } from './chart-data.js' */

/**
 * @typedef {{
 *   x: number, y: number | null, text: string, link?: string
 * }} Hit what is at a place of the axes; without y it is read across all that is drawn
 * @typedef {{x0: number, x1: number, y0: number, y1: number}} View
 * @typedef {{left: number, right: number, top: number, bottom: number}} Margins
 * @typedef {object} Drawing
 * @property {Axis} x
 * @property {Axis} y
 * @property {View} home all that there is
 * @property {boolean} [isEven] whether both axes are to the same scale
 * @property {Margins} [margins]
 * @property {'full' | 'levels' | ((plot: Plot, g: CanvasRenderingContext2D) => void)} [frame] ticks and labels: of both axes, of that
 *   upwards with numbers alone at the other, or its own
 * @property {string} name what is shown, for those who do not see it
 * @property {(plot: Plot, g: CanvasRenderingContext2D) => void} draw
 * @property {(plot: Plot, g: CanvasRenderingContext2D) => void} [drawOver] what moves
 * @property {(plot: Plot, x: number, y: number) => Hit | null} find what is nearest to a place in pixels
 * @property {() => Hit[]} [list] what the arrow keys step through; without it the plot takes no keys
 * @property {(plot: Plot, x: number, y: number) => void} [onPoint] what pressing and dragging does, in place of zooming
 * @property {() => (string | number | null)[][]} [rows] its figures as a table, the heads first
 */

/** Margins of a plot whose axes have labels. */
const MARGINS = { left: 66, right: 12, top: 10, bottom: 40 };

/** A line through places in pixels. @param {CanvasRenderingContext2D} g @param {...[number, number]} places */
export function stroke(g, ...places) {
  g.beginPath();
  places.forEach(([x, y], k) => (k ? g.lineTo(x, y) : g.moveTo(x, y)));
  g.stroke();
}

/** @param {CanvasRenderingContext2D} g @param {number} x @param {number} y @param {number} radius @param {string} colour */
export function disc(g, x, y, radius, colour) {
  g.fillStyle = colour;
  g.beginPath();
  g.arc(x, y, radius, 0, 2 * Math.PI);
  g.fill();
}

/** The plots by the elements that they are in. @type {Map<Element, Plot>} */
export const PLOTS = new Map();

/** Whether the page is being printed, and the theme that it had before. */
const root = document.documentElement;
let isPaper = false;
/** @type {string | undefined} */
let theme;
// On paper plots are drawn anew, as wide as it is and in its colours, and are pictures: canvases would stay empty.
addEventListener('beforeprint', () => {
  if (!isPaper) theme = root.dataset.theme;
  isPaper = true;
  root.dataset.theme = 'light';
  root.classList.add('paper');
  PLOTS.forEach((plot) => plot.resize());
  PLOTS.forEach((plot, host) => host.append(el('img.paper', { src: plot.picture(), alt: '' })));
});
addEventListener('afterprint', () => {
  isPaper = false;
  root.classList.remove('paper');
  if (theme) root.dataset.theme = theme;
  else delete root.dataset.theme;
  document.querySelectorAll('img.paper').forEach((picture) => picture.remove());
  PLOTS.forEach((plot) => plot.resize());
});

export class Plot {
  /** @param {HTMLElement} host @param {() => Drawing} make what is drawn, anew at each `refresh` */
  constructor(host, make) {
    this.host = host;
    PLOTS.set(host, this);
    this.make = make;
    this.drawing = make();
    this.view = { ...this.drawing.home };
    const { name, list } = this.drawing;
    this.base = canvasOf();
    const keys = 'arrow keys: values; plus, minus: zoom; 0: all';
    this.top = canvasOf(list ? { 'aria-hidden': null, tabindex: '0', role: 'img', 'aria-label': `${name}; ${keys}` } : {});
    if (!list) {
      host.setAttribute('role', 'img');
      host.setAttribute('aria-label', name);
    }
    this.tip = el('div.tip', { role: 'status' });
    host.append(this.base, this.top, this.tip);
    this.width = this.height = 0;
    /** @type {Hit | null} */
    this.hit = null;
    this.step = -1;
    /** @type {{x: number, y: number} | null} */
    this.start = null;
    this.listen();
    new ResizeObserver(() => this.resize()).observe(host);
    onTheme(() => this.draw());
  }

  listen() {
    const { top } = this;
    const at = (/** @type {MouseEvent} */ event) => {
      const box = top.getBoundingClientRect();
      return { x: event.clientX - box.left, y: event.clientY - box.top };
    };
    top.addEventListener('pointermove', (event) => {
      const { x, y } = at(event);
      this.show(this.start ? null : this.drawing.find(this, x, y));
      if (this.start) this.frame(this.start, { x, y });
      else if (event.buttons) this.drawing.onPoint?.(this, x, y);
    });
    top.addEventListener('pointerleave', () => this.show(null));
    top.addEventListener('pointercancel', () => {
      this.start = null;
      this.show(null);
    });
    top.addEventListener('blur', () => this.show(null));
    top.addEventListener('pointerdown', (event) => {
      const { x, y } = at(event);
      if (this.drawing.onPoint) this.drawing.onPoint(this, x, y);
      else if (event.pointerType === 'touch' || event.button !== 0) return;
      else this.start = { x, y };
      top.setPointerCapture(event.pointerId);
    });
    if (this.drawing.onPoint) return;
    top.addEventListener('pointerup', (event) => {
      const [start, end] = [this.start, at(event)];
      this.start = null;
      const isDrag = start && Math.abs(end.x - start.x) > 6 && Math.abs(end.y - start.y) > 6;
      if (start && isDrag) this.zoomTo(start, end);
      else this.follow(this.drawing.find(this, end.x, end.y));
    });
    top.addEventListener('dblclick', () => this.reset());
    top.addEventListener(
      'wheel',
      (event) => {
        event.preventDefault();
        const { x, y } = at(event);
        this.zoom(Math.exp(clamp(event.deltaY, -60, 60) * 0.004), x, y);
      },
      { passive: false },
    );
    if (this.drawing.list) top.addEventListener('keydown', (event) => this.key(event));
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { key } = event;
    const direction = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[key];
    if (direction || key === 'Home' || key === 'End') {
      const list = this.drawing.list?.() ?? [];
      if (list.length === 0) return;
      const last = list.length - 1;
      if (!direction || this.step < 0) this.step = direction === 1 || key === 'Home' ? 0 : last;
      else this.step = clamp(this.step + direction * (event.shiftKey ? 10 : 1), 0, last);
      this.show(list[this.step]);
    } else if (key === '+' || key === '=') this.zoom(0.7);
    else if (key === '-') this.zoom(1 / 0.7);
    else if (key === '0' || key === 'Escape') this.reset();
    else if (key === 'Enter') this.follow(this.hit);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** @param {Hit | null} hit */
  follow(hit) {
    if (hit?.link) location.assign(hit.link);
  }

  reset() {
    this.view = { ...this.drawing.home };
    this.draw();
  }

  /** Makes and draws anew what is shown. */
  refresh() {
    this.drawing = this.make();
    this.reset();
  }

  /** Draws anew what moves. */
  over() {
    this.show(this.hit);
  }

  /**
   * Shows so much more or less, about a pixel or the middle, but never more than there is.
   * @param {number} factor @param {number} [x] @param {number} [y]
   */
  zoom(factor, x = (this.left + this.right) / 2, y = (this.upper + this.lower) / 2) {
    const [px, py] = [this.placeX(x), this.placeY(y)];
    const { x0, x1, y0, y1 } = this.view;
    this.look({
      x0: px + (x0 - px) * factor,
      x1: px + (x1 - px) * factor,
      y0: py + (y0 - py) * factor,
      y1: py + (y1 - py) * factor,
    });
  }

  /** @param {{x: number, y: number}} from @param {{x: number, y: number}} to */
  zoomTo(from, to) {
    const [a, b] = [this.placeX(from.x), this.placeX(to.x)];
    const [c, d] = [this.placeY(from.y), this.placeY(to.y)];
    this.look({ x0: Math.min(a, b), x1: Math.max(a, b), y0: Math.min(c, d), y1: Math.max(c, d) });
  }

  /** @param {View} view */
  look(view) {
    const { home } = this.drawing;
    const isTiny = view.x1 - view.x0 < 1e-7 * (home.x1 - home.x0) || view.y1 - view.y0 < 1e-7 * (home.y1 - home.y0);
    if (isTiny) return;
    if (view.x1 - view.x0 >= home.x1 - home.x0 && view.y1 - view.y0 >= home.y1 - home.y0) return this.reset();
    this.view = view;
    this.draw();
  }

  resize() {
    const box = this.host.getBoundingClientRect();
    const ratio = this.ratio;
    [this.width, this.height] = [box.width, box.height];
    for (const canvas of [this.base, this.top]) {
      canvas.width = Math.round(box.width * ratio);
      canvas.height = Math.round(box.height * ratio);
    }
    this.draw();
  }

  /** As it looks now. */
  picture() {
    const whole = canvasOf({ width: this.base.width, height: this.base.height });
    const g = contextOf(whole);
    g.fillStyle = '#fff';
    g.fillRect(0, 0, whole.width, whole.height);
    for (const layer of whole.width ? [this.base, this.top] : []) g.drawImage(layer, 0, 0);
    return whole.toDataURL();
  }

  /** Dots of a canvas to a pixel. */
  get ratio() {
    return Math.max(isPaper ? 3 : 1, devicePixelRatio);
  }
  get margins() {
    return this.drawing.margins ?? MARGINS;
  }
  get left() {
    return this.margins.left;
  }
  get right() {
    return this.width - this.margins.right;
  }
  get upper() {
    return this.margins.top;
  }
  get lower() {
    return this.height - this.margins.bottom;
  }

  /** The view as it fills the plot: wider or higher where both axes are to the same scale. */
  get filled() {
    const { x0, x1, y0, y1 } = this.view;
    if (!this.drawing.isEven) return this.view;
    const scale = Math.min((this.right - this.left) / (x1 - x0), (this.lower - this.upper) / (y1 - y0));
    const [dx, dy] = [(this.right - this.left) / scale / 2, (this.lower - this.upper) / scale / 2];
    return { x0: (x0 + x1) / 2 - dx, x1: (x0 + x1) / 2 + dx, y0: (y0 + y1) / 2 - dy, y1: (y0 + y1) / 2 + dy };
  }

  /** @param {number} place */
  pixelX(place) {
    const { x0, x1 } = this.filled;
    return this.left + ((place - x0) / (x1 - x0)) * (this.right - this.left);
  }

  /** @param {number} place */
  pixelY(place) {
    const { y0, y1 } = this.filled;
    return this.lower - ((place - y0) / (y1 - y0)) * (this.lower - this.upper);
  }

  /** @param {number} pixel */
  placeX(pixel) {
    const { x0, x1 } = this.filled;
    return x0 + ((pixel - this.left) / (this.right - this.left)) * (x1 - x0);
  }

  /** @param {number} pixel */
  placeY(pixel) {
    const { y0, y1 } = this.filled;
    return y0 + ((this.lower - pixel) / (this.lower - this.upper)) * (y1 - y0);
  }

  /** A canvas, cleared, in CSS pixels. @param {HTMLCanvasElement} canvas */
  cleared(canvas) {
    const g = contextOf(canvas);
    const { ratio } = this;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, this.width, this.height);
    g.font = `11px ${getComputedStyle(document.body).fontFamily}`;
    g.lineWidth = 1;
    return g;
  }

  draw() {
    if (this.width < 80 || this.height < 60) return;
    const g = this.cleared(this.base);
    const { home, frame = 'full', draw } = this.drawing;
    this.host.dataset.zoomed = String(this.view.x1 - this.view.x0 < 0.999 * (home.x1 - home.x0));
    g.save();
    if (typeof frame === 'function') frame(this, g);
    else this.axes(g, frame === 'full');
    g.restore();
    g.save();
    g.beginPath();
    // With the line around it.
    g.rect(this.left - 1, this.upper - 1, this.right - this.left + 2, this.lower - this.upper + 2);
    g.clip();
    draw(this, g);
    g.restore();
    this.show(null);
  }

  /** @param {CanvasRenderingContext2D} g @param {boolean} isFull */
  axes(g, isFull) {
    const { x, y } = this.drawing;
    const { x0, x1, y0, y1 } = this.filled;
    g.strokeStyle = themeColour('--grid');
    g.fillStyle = themeColour('--soft');
    g.textBaseline = 'middle';
    g.textAlign = 'right';
    for (const { at, label } of ticks(y, y0, y1, Math.max(2, this.height / (isFull ? 55 : 45)))) {
      const pixel = Math.round(this.pixelY(at)) + 0.5;
      stroke(g, [this.left, pixel], [this.right, pixel]);
      g.fillText(label, this.left - 6, pixel, this.left - (isFull ? 24 : 8));
    }
    g.textAlign = 'center';
    g.textBaseline = 'top';
    const count = isFull ? Math.max(2, this.width / 90) : 5;
    for (const { at, label } of ticks(x, x0, x1, count)) {
      const pixel = Math.round(this.pixelX(at)) + 0.5;
      if (isFull) stroke(g, [pixel, this.upper], [pixel, this.lower]);
      g.fillText(label, pixel, this.lower + 6, (this.right - this.left) / count - 6);
    }
    if (!isFull) return;
    g.fillText(x.label, (this.left + this.right) / 2, this.lower + 23);
    g.translate(4, (this.upper + this.lower) / 2);
    g.rotate(-Math.PI / 2);
    g.fillText(y.label, 0, 0, this.lower - this.upper);
    g.rotate(Math.PI / 2);
    g.translate(-4, -(this.upper + this.lower) / 2);
    g.strokeStyle = themeColour('--line');
    g.strokeRect(this.left + 0.5, this.upper + 0.5, this.right - this.left - 1, this.lower - this.upper - 1);
  }

  /** What moves, and what the pointer found, or nothing. @param {Hit | null} hit */
  show(hit) {
    this.hit = hit;
    const g = this.cleared(this.top);
    this.drawing.drawOver?.(this, g);
    this.tip.style.opacity = hit ? '1' : '0';
    this.top.style.cursor = hit?.link ? 'pointer' : 'crosshair';
    if (!hit) return;
    const [x, y] = [this.pixelX(hit.x), hit.y === null ? this.upper + 70 : this.pixelY(hit.y)];
    if (hit.y !== null) {
      g.strokeStyle = themeColour('--ink');
      g.lineWidth = 1.5;
      g.beginPath();
      g.arc(x, y, 5, 0, 2 * Math.PI);
      g.stroke();
    }
    this.tip.textContent = hit.text;
    const half = this.tip.offsetWidth / 2 + 4;
    this.tip.style.left = `${Math.min(this.width - half, Math.max(half, x))}px`;
    const isHigh = y < this.tip.offsetHeight + 16;
    this.tip.style.top = `${(isHigh ? y + this.tip.offsetHeight + 24 : y) - 10}px`;
  }

  /** The frame of what will be shown. @param {{x: number, y: number}} from @param {{x: number, y: number}} to */
  frame(from, to) {
    const g = contextOf(this.top);
    g.strokeStyle = themeColour('--accent');
    g.setLineDash([4, 3]);
    g.strokeRect(from.x, from.y, to.x - from.x, to.y - from.y);
    g.setLineDash([]);
  }
}

/**
 * A card with a plot in it, its buttons, and what is written under it.
 * @param {{title: string, detail: string}} card @param {() => Drawing} make @param {Node[]} legend
 * @returns {{section: HTMLElement, plot: Plot}}
 */
export function plotCard(card, make, legend) {
  const host = el('div.plot');
  const buttons = el('span.zoom');
  const head = el('div.head', {}, el('h2', {}, card.title), el('span.sub', {}, card.detail), buttons);
  const section = el('section.card', { 'aria-label': card.title }, head, host);
  if (legend.length > 0) section.append(el('div.legend', {}, ...legend));
  const plot = new Plot(host, make);
  for (const [sign, name, onclick] of /** @type {[string, string, () => void][]} */ ([
    ['+', 'Zoom in', () => plot.zoom(0.7)],
    ['−', 'Zoom out', () => plot.zoom(1 / 0.7)],
    ['⤢', 'Show all', () => plot.reset()],
  ])) {
    const label = { type: 'button', 'aria-label': `${name}: ${card.title}`, title: name, onclick };
    buttons.append(el('button.chip', label, sign));
  }
  return { section, plot };
}
