// The list of files: a box shows or hides one, a click on the name shows it alone. Long lists have a
// filter, and only the rows in view are made.

// Pixels, as in style.css.
const ROW = matchMedia('(pointer: coarse)').matches ? 48 : 40;
const FILTERED = 8; // files from which on there is a filter
const BEYOND = 4; // rows made above and below those in view

const SHORT = 24; // letters that have place

// How many letters all names begin with, up to the end of a word.
function commonStart(names) {
  const [first = '', ...others] = names;
  let count = 0;
  while (count < first.length && others.every((name) => name[count] === first[count])) ++count;
  while (count > 0 && /[a-z0-9]/i.test(first[count - 1])) --count;
  return others.length > 0 ? count : 0;
}

// A long name in two, of which the front is cut where there is no place: takes of a session differ at
// their ends.
function parted(full, common) {
  // What all names begin with does not distinguish them.
  const name = full.length > SHORT && common > 3 ? `…${full.slice(common)}` : full;
  if (name.length <= SHORT) return [name];
  return [name.slice(0, -12), name.slice(-12)].map((part) => {
    const span = document.createElement('span');
    span.textContent = part;
    return span;
  });
}

export class FilesList {
  // `show(items)`: shows exactly these, and calls refresh(); `choose(made, clip)`: plays another clip.
  constructor(root, player, { show, choose }) {
    this.player = player;
    this.show = show;
    this.choose = choose;
    this.list = root.querySelector('#items');
    this.box = root.querySelector('#items-box');
    this.filter = root.querySelector('#filter');
    this.count = root.querySelector('#file-count');
    this.rows = new Map();
    this.common = commonStart(player.items.map(({ name }) => name));
    this.filter.hidden = player.items.length <= FILTERED;
    this.filter.addEventListener('input', () => this.refresh());
    this.box.addEventListener('scroll', () => this.fill());
    new ResizeObserver(() => this.fill()).observe(this.box);
  }

  get found() {
    const words = this.filter.value.trim().toLowerCase().split(/\s+/).filter(Boolean);
    return this.player.items.filter(({ name }) => words.every((word) => name.toLowerCase().includes(word)));
  }

  // After a change of what is shown.
  refresh() {
    const { items } = this.player;
    this.shownFiles = this.found;
    this.list.style.height = `${this.shownFiles.length * ROW}px`;
    // Three rows stay in view, however much is below.
    const least = Math.min(items.length, 3) * ROW;
    this.box.parentElement.style.minHeight = `${least + 30 + (this.filter.hidden ? 0 : 40)}px`;
    const visible = items.filter((made) => made.visible).length;
    this.count.textContent = items.length > 1
      ? `${visible} of ${items.length} shown${this.filter.value ? `, ${this.shownFiles.length} found` : ''}` : '';
    this.list.replaceChildren();
    this.rows.clear();
    this.fill();
  }

  fill() {
    const { scrollTop, clientHeight } = this.box;
    const first = Math.max(0, Math.floor(scrollTop / ROW) - BEYOND);
    const last = Math.min(this.shownFiles.length, Math.ceil((scrollTop + clientHeight) / ROW) + BEYOND);
    for (const [place, row] of this.rows) {
      if ((place >= first && place < last) || row.contains(document.activeElement)) continue;
      row.remove();
      this.rows.delete(place);
    }
    for (let place = first; place < last; ++place) {
      if (this.rows.has(place)) continue;
      const row = this.makeRow(this.shownFiles[place], place);
      this.rows.set(place, row);
      // In the order of the list, for the keyboard and for screen readers.
      const after = [...this.list.children].find((each) => Number(each.ariaPosInSet) > place + 1);
      this.list.insertBefore(row, after ?? null);
    }
  }

  makeRow(made, place) {
    const row = document.createElement('li');
    row.style.top = `${place * ROW}px`;
    row.ariaPosInSet = String(place + 1);
    row.ariaSetSize = String(this.shownFiles.length);
    const box = document.createElement('input');
    box.type = 'checkbox';
    box.id = `item-${made.index}`;
    box.checked = made.visible;
    box.setAttribute('aria-label', `Show ${made.name}`);
    box.addEventListener('change', () => {
      this.before = null;
      this.show(this.player.items.filter((each) => (each === made ? box.checked : each.visible)));
    });
    const swatch = document.createElement('span');
    swatch.className = 'swatch';
    swatch.style.background = made.colour ?? 'transparent';
    const name = document.createElement('button');
    name.type = 'button';
    name.className = 'name';
    name.title = `${made.name}: show only this file; again: as before`;
    const words = document.createElement('span');
    words.append(...parted(made.name, this.common));
    const facts = document.createElement('span');
    facts.className = 'facts';
    facts.textContent = made.item.facts ?? '';
    name.append(words, facts);
    name.addEventListener('click', () => this.solo(made));
    row.append(box, swatch, name);
    const clips = made.actor?.clips ?? [];
    if (clips.length > 1) row.append(this.clipChoice(made, clips));
    return row;
  }

  clipChoice(made, clips) {
    const select = document.createElement('select');
    select.setAttribute('aria-label', `Clip of ${made.name}`);
    clips.forEach((clip, i) => {
      select.add(new Option(clip.name || `clip ${i + 1}`, i, false, i === made.actor.animation));
    });
    select.addEventListener('change', () => this.choose(made, Number(select.value)));
    return select;
  }

  // Shows one file alone; a second time what was shown before.
  solo(made) {
    const shown = this.player.items.filter(({ visible }) => visible);
    const alone = shown.length === 1 && shown[0] === made;
    if (alone && this.before) {
      this.show(this.before);
      this.before = null;
      return;
    }
    if (alone) return;
    if (shown.length > 1) this.before = shown;
    this.show([made]);
  }

  // The file after or before the first that is shown, of those found.
  turnPage(step) {
    const files = this.found;
    if (files.length === 0) return;
    const at = files.findIndex(({ visible }) => visible);
    const next = files[(at + step + files.length) % files.length];
    this.show([next]);
    this.scrollTo(next);
  }

  scrollTo(made) {
    const top = this.shownFiles.indexOf(made) * ROW;
    if (top < this.box.scrollTop) this.box.scrollTop = top;
    if (top + ROW > this.box.scrollTop + this.box.clientHeight) this.box.scrollTop = top + ROW - this.box.clientHeight;
    this.fill();
  }
}
