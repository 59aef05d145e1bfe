// A plot: two canvases, one for what is shown and one for what the pointer finds, with zoom by wheel, drag, buttons and keys.

/**
 * @typedef {{x: number, y: number, text: string, link?: string}} Hit What is at a place: where (in places of the axes) and what.
 * @typedef {{x0: number, x1: number, y0: number, y1: number}} View
 * @typedef {object} Drawing
 * @property {Axis} x
 * @property {Axis} y
 * @property {View} home all that there is
 * @property {boolean} isEven whether both axes are to the same scale
 * @property {boolean} [hasNoAxes] whether it has neither ticks nor frame
 * @property {string} name what is shown, for those who do not see it
 * @property {(plot: Plot, g: CanvasRenderingContext2D) => void} draw
 * @property {(plot: Plot, x: number, y: number) => Hit | null} find what is nearest to a place in pixels
 * @property {() => Hit[]} list what the arrow keys step through
 */

class Plot {
  /**
   * @param {HTMLElement} host
   * @param {Drawing} drawing
   */
  constructor(host, drawing) {
    this.drawing = drawing;
    /** @type {View} */
    this.view = { ...drawing.home };
    this.base = /** @type {HTMLCanvasElement} */ (element('canvas', { 'aria-hidden': 'true' }));
    const keys = 'arrow keys: values; plus, minus: zoom; 0: all';
    this.top = /** @type {HTMLCanvasElement} */ (
      element('canvas', { tabindex: '0', role: 'img', 'aria-label': `${drawing.name}; ${keys}` }));
    this.tip = element('div', { class: 'tip', role: 'status' });
    host.append(this.base, this.top, this.tip);
    this.host = host;
    this.width = this.height = 0;
    /** @type {Hit | null} */
    this.hit = null;
    this.step = -1;
    /** @type {{x: number, y: number} | null} */
    this.start = null;
    this.listen();
    new ResizeObserver(() => this.resize()).observe(host);
    themeListeners.push(() => this.draw());
  }

  listen() {
    const { top } = this;
    const at = (/** @type {MouseEvent} */ event) => {
      const box = top.getBoundingClientRect();
      return { x: event.clientX - box.left, y: event.clientY - box.top };
    };
    top.addEventListener('pointermove', event => {
      const { x, y } = at(event);
      this.show(this.start ? null : this.drawing.find(this, x, y));
      if (this.start) this.frame(this.start, { x, y });
    });
    top.addEventListener('pointerleave', () => this.show(null));
    top.addEventListener('pointerdown', event => {
      if (event.pointerType === 'touch' || event.button !== 0) return;
      this.start = at(event);
      top.setPointerCapture(event.pointerId);
    });
    top.addEventListener('pointerup', event => {
      const [start, end] = [this.start, at(event)];
      this.start = null;
      const isDrag = start && Math.abs(end.x - start.x) > 6 && Math.abs(end.y - start.y) > 6;
      if (start && isDrag) this.zoomTo(start, end);
      else this.follow(this.drawing.find(this, end.x, end.y));
    });
    top.addEventListener('pointercancel', () => { this.start = null; this.show(null); });
    top.addEventListener('dblclick', () => this.reset());
    top.addEventListener('wheel', event => {
      event.preventDefault();
      const { x, y } = at(event);
      this.zoom(Math.exp(Math.max(-60, Math.min(60, event.deltaY)) * 0.004), x, y);
    }, { passive: false });
    top.addEventListener('keydown', event => this.key(event));
    top.addEventListener('blur', () => this.show(null));
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const direction = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (direction) {
      const list = this.drawing.list();
      if (list.length === 0) return;
      const stride = event.shiftKey ? 10 : 1;
      const first = direction > 0 ? 0 : list.length - 1;
      this.step = this.step < 0 ? first : Math.min(list.length - 1, Math.max(0, this.step + direction * stride));
      this.show(list[this.step]);
    } else if (event.key === 'Home' || event.key === 'End') {
      const list = this.drawing.list();
      if (list.length === 0) return;
      this.step = event.key === 'Home' ? 0 : list.length - 1;
      this.show(list[this.step]);
    } else if (event.key === '+' || event.key === '=') this.zoom(0.7);
    else if (event.key === '-') this.zoom(1 / 0.7);
    else if (event.key === '0' || event.key === 'Escape') this.reset();
    else if (event.key === 'Enter') this.follow(this.hit);
    else return;
    event.preventDefault();
  }

  /** @param {Hit | null} hit */
  follow(hit) {
    if (hit?.link) location.assign(hit.link);
  }

  reset() {
    this.view = { ...this.drawing.home };
    this.draw();
  }

  /**
   * Shows so much more or less, about a pixel or the middle, but never more than there is.
   * @param {number} factor
   * @param {number} [x]
   * @param {number} [y]
   */
  zoom(factor, x = (this.left + this.right) / 2, y = (this.upper + this.lower) / 2) {
    const [px, py] = [this.placeX(x), this.placeY(y)];
    const { x0, x1, y0, y1 } = this.view;
    this.look({ x0: px + (x0 - px) * factor, x1: px + (x1 - px) * factor, y0: py + (y0 - py) * factor, y1: py + (y1 - py) * factor });
  }

  /**
   * @param {{x: number, y: number}} from
   * @param {{x: number, y: number}} to
   */
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
    const ratio = Math.max(1, devicePixelRatio);
    [this.width, this.height] = [box.width, box.height];
    for (const canvas of [this.base, this.top]) {
      canvas.width = Math.round(box.width * ratio);
      canvas.height = Math.round(box.height * ratio);
    }
    this.draw();
  }

  get left() { return this.drawing.hasNoAxes ? 4 : 66; }
  get right() { return this.width - (this.drawing.hasNoAxes ? 4 : 12); }
  get upper() { return this.drawing.hasNoAxes ? 4 : 10; }
  get lower() { return this.height - (this.drawing.hasNoAxes ? 4 : 40); }

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
    return this.left + (place - x0) / (x1 - x0) * (this.right - this.left);
  }

  /** @param {number} place */
  pixelY(place) {
    const { y0, y1 } = this.filled;
    return this.lower - (place - y0) / (y1 - y0) * (this.lower - this.upper);
  }

  /** @param {number} pixel */
  placeX(pixel) {
    const { x0, x1 } = this.filled;
    return x0 + (pixel - this.left) / (this.right - this.left) * (x1 - x0);
  }

  /** @param {number} pixel */
  placeY(pixel) {
    const { y0, y1 } = this.filled;
    return y0 + (this.lower - pixel) / (this.lower - this.upper) * (y1 - y0);
  }

  /**
   * @param {HTMLCanvasElement} canvas
   * @returns {CanvasRenderingContext2D | null}
   */
  context(canvas) {
    const g = canvas.getContext('2d');
    const ratio = Math.max(1, devicePixelRatio);
    g?.setTransform(ratio, 0, 0, ratio, 0, 0);
    g?.clearRect(0, 0, this.width, this.height);
    return g;
  }

  draw() {
    const g = this.context(this.base);
    if (!g || this.width < 80 || this.height < 60) return;
    this.host.dataset.zoomed = String(this.view.x1 - this.view.x0 < 0.999 * (this.drawing.home.x1 - this.drawing.home.x0));
    g.font = `11px ${getComputedStyle(document.body).fontFamily}`;
    if (!this.drawing.hasNoAxes) this.axes(g);
    g.save();
    g.beginPath();
    g.rect(this.left, this.upper, this.right - this.left, this.lower - this.upper);
    g.clip();
    this.drawing.draw(this, g);
    g.restore();
    this.show(null);
  }

  /** @param {CanvasRenderingContext2D} g */
  axes(g) {
    const { x, y } = this.drawing;
    const { x0, x1, y0, y1 } = this.filled;
    g.lineWidth = 1;
    g.strokeStyle = themeColour('--grid');
    g.fillStyle = themeColour('--soft');
    g.textBaseline = 'middle';
    g.textAlign = 'right';
    for (const { at, label } of ticks(y, y0, y1, Math.max(2, this.height / 55))) {
      const pixel = Math.round(this.pixelY(at)) + 0.5;
      g.beginPath();
      g.moveTo(this.left, pixel);
      g.lineTo(this.right, pixel);
      g.stroke();
      g.fillText(label, this.left - 6, pixel, this.left - 24);
    }
    g.textAlign = 'center';
    g.textBaseline = 'top';
    const room = (this.right - this.left) / Math.max(2, this.width / 90);
    for (const { at, label } of ticks(x, x0, x1, Math.max(2, this.width / 90))) {
      const pixel = Math.round(this.pixelX(at)) + 0.5;
      g.beginPath();
      g.moveTo(pixel, this.upper);
      g.lineTo(pixel, this.lower);
      g.stroke();
      g.fillText(label, pixel, this.lower + 6, room - 6);
    }
    g.fillText(x.label, (this.left + this.right) / 2, this.lower + 23);
    g.save();
    g.translate(4, (this.upper + this.lower) / 2);
    g.rotate(-Math.PI / 2);
    g.fillText(y.label, 0, 0, this.lower - this.upper);
    g.restore();
    g.strokeStyle = themeColour('--line');
    g.strokeRect(this.left + 0.5, this.upper + 0.5, this.right - this.left - 1, this.lower - this.upper - 1);
  }

  /**
   * What the pointer found, or nothing.
   * @param {Hit | null} hit
   */
  show(hit) {
    this.hit = hit;
    const g = this.context(this.top);
    this.tip.style.opacity = hit ? '1' : '0';
    this.top.style.cursor = hit?.link ? 'pointer' : 'crosshair';
    if (!hit || !g) return;
    const [x, y] = [this.pixelX(hit.x), this.pixelY(hit.y)];
    g.strokeStyle = themeColour('--ink');
    g.lineWidth = 1.5;
    g.beginPath();
    g.arc(x, y, 5, 0, 2 * Math.PI);
    g.stroke();
    this.tip.textContent = hit.text;
    const half = this.tip.offsetWidth / 2 + 4;
    this.tip.style.left = `${Math.min(this.width - half, Math.max(half, x))}px`;
    const isHigh = y < this.tip.offsetHeight + 16;
    this.tip.style.top = `${isHigh ? y + this.tip.offsetHeight + 24 : y}px`;
  }

  /**
   * The frame of what will be shown.
   * @param {{x: number, y: number}} from
   * @param {{x: number, y: number}} to
   */
  frame(from, to) {
    const g = this.context(this.top);
    if (!g) return;
    g.strokeStyle = themeColour('--accent');
    g.setLineDash([4, 3]);
    g.strokeRect(from.x, from.y, to.x - from.x, to.y - from.y);
    g.setLineDash([]);
  }
}

/**
 * A card with a plot in it, its buttons, and what is written under it.
 * @param {{title: string, detail: string}} card
 * @param {Drawing} drawing
 * @param {Node[]} legend
 * @returns {{section: HTMLElement, plot: Plot}}
 */
function plotCard(card, drawing, legend) {
  const host = element('div', { class: 'plot' });
  const buttons = element('span', { class: 'zoom' });
  const head = element('div', { class: 'head' }, element('h2', {}, card.title), element('span', { class: 'sub' }, card.detail), buttons);
  const section = element('section', { class: 'card', 'aria-label': card.title }, head, host);
  if (legend.length > 0) section.append(element('div', { class: 'legend' }, ...legend));
  const plot = new Plot(host, drawing);
  for (const [sign, name, act] of /** @type {[string, string, () => void][]} */ ([
    ['+', 'Zoom in', () => plot.zoom(0.7)], ['−', 'Zoom out', () => plot.zoom(1 / 0.7)], ['⤢', 'Show all', () => plot.reset()]])) {
    const button = element('button', { type: 'button', class: 'chip', 'aria-label': `${name}: ${card.title}`, title: name }, sign);
    button.addEventListener('click', act);
    buttons.append(button);
  }
  return { section, plot };
}
