// The last ticks of the fast process, for plots and for a table.

const kSeconds = 60;

export class History {
  constructor(keys) {
    this.keys = keys;
    this.column = Object.fromEntries(keys.map((key) => [key, []]));
  }

  add(trace) {
    for (const key of this.keys) {
      this.column[key].push(...trace[key]);
    }
    const time = this.column.time_s;
    if (time.length > 0 && time[time.length - 1] - time[0] > 1.2 * kSeconds) {
      const from = this.first(kSeconds);
      for (const key of this.keys) {
        this.column[key] = this.column[key].slice(from);
      }
    }
  }

  clear() {
    for (const key of this.keys) {
      this.column[key] = [];
    }
  }

  // Index of the first tick of the last `seconds`.
  first(seconds) {
    const time = this.column.time_s;
    const begin = time[time.length - 1] - seconds;
    let low = 0;
    let high = time.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (time[middle] < begin) { low = middle + 1; } else { high = middle; }
    }
    return low;
  }

  // Of the last `seconds`, about `points` of them, always the same ticks, so that a plot
  // does not shimmer as it moves.
  recent(seconds, points, keys) {
    const time = this.column.time_s;
    const from = this.first(seconds);
    const stride = Math.max(1, Math.ceil((time.length - from) / points));
    const kept = keys.map(() => []);
    for (let i = time.length - 1 - ((time.length - 1) % stride); i >= from; i -= stride) {
      keys.forEach((key, k) => kept[k].push(this.column[key][i]));
    }
    return kept.map((values) => values.reverse());
  }

  csv() {
    const rows = [this.keys.join(",")];
    for (let i = 0; i < this.column.time_s.length; ++i) {
      rows.push(this.keys.map((key) => this.column[key][i]).join(","));
    }
    return rows.join("\n") + "\n";
  }
}
