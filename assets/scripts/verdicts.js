// How what is played compares with the best, where no server tells it: `verdict_on` of by_hand, slack and drawing in
// dashboard/pages/learn, from the data and in the words of dashboard/pages/learn/alone.

import {between_points, drive, drive_drawn, net_energy, read} from "./driving.js";
import {J_PER_KWH, KMH_PER_MS, clock_of, figures_of} from "./played.js";
import {price_of, total_kwh} from "./slack.js";

// Words with {names} in braces, filled in.
const told = (text, values) => text.replace(/\{(\w+)\}/g, (_, name) => values[name]);
const thousands = (value) => figures_of(value, 0).replace(/(\d)(?=\d{3}$)/, "$1\u202f");
// of two words, the second is that of a difference below zero
const which = (words, difference) => words[difference < 0 ? 1 : 0];

const account_of = (run) => ({kwh: net_energy(run.sums.at(-1)) / J_PER_KWH, time_s: run.sums.at(-1).time});
const so_far_kwh = (run) => run.sums.map((sum) => net_energy(sum) / J_PER_KWH);
const differences = (values, others) => values.map((one, i) => one - others[i]);
const beyond = (run, best, words) => Object.entries(words.beyond)
  .map(([name, label]) => [label, run.sums.at(-1)[name] / J_PER_KWH - best.spent_kwh[name], name])
  .filter(([, kwh, name]) => kwh !== 0 || name !== "auxiliary").map(([label, kwh]) => [label, kwh]);

const last_index = (values, holds) => {
  for (let i = values.length - 1; i >= 0; i--) { if (holds(values[i])) { return i; } }
  return -1;
};
// The node from which on a try differs in speed from the optimum, with the numbers of `parting_node`.
const parting_of = ({course, best, parted_ms, words}, commands, speeds, above) => {
  const apart = differences(speeds, best.ms).map(Math.abs), parted = apart.findIndex((one) => one >= parted_ms);
  if (parted < 0) { return null; }
  const node = Math.max(last_index(apart.slice(0, parted), (one) => one <= 0.1 * parted_ms), 0);
  const [, phase] = best.phases.find(([end]) => end >= course.position[node + 1]);
  const other = commands.findIndex((one, i) => i >= node && one !== commands[node]);
  const end = other < 0 ? commands.length : other, faster = speeds[end] - best.ms[end], cost = Math.abs(above[end]);
  return {
    position: course.position[node], node,
    here: told(words.here, {place: thousands(course.position[node]), phase}),
    there: told(words.there, {
      did: words.did[commands[node]], place: thousands(course.position[end]),
      speed: figures_of(Math.abs(faster) * KMH_PER_MS, 0), faster: which(words.faster, faster),
      energy: figures_of(cost, cost < words.small_kwh ? 3 : 2), more: which(words.more, above[end]),
    }),
  };
};

// Of a try, its commands as a text.
export const drive_verdict = (lesson, text) => {
  const {course, best, timetable_s, in_time_s, words} = lesson;
  const commands = read(text, course.length.length), run = drive(course, commands), account = account_of(run);
  const above = differences(so_far_kwh(run), best.so_far_kwh), late = account.time_s - timetable_s;
  return {
    ...account, commands: text, late_s: late, counts: late <= in_time_s, bound_kwh: best.bound_kwh, proven: best.proven,
    best_kwh: best.kwh, best_ms: best.ms, above_kwh: above, rows: beyond(run, best, words),
    parting: parting_of(lesson, commands, run.speed2.map(Math.sqrt), above),
  };
};

// Of a sharing, the name of its line and the seconds of its legs.
export const sharing_verdict = ({lines, best, alike_s, words}, text) => {
  const [name, shared] = text.split(":"), seconds = shared.split(",").map(Number), line = lines[name];
  const sentence = (leg, k) => {
    const more = seconds[k] - best[name].best_s[k], price = price_of(line, seconds, k);
    return told(Math.abs(more) < alike_s ? words.as_best : more > 0 ? words.too_many : words.too_few, {
      leg: `${leg.from} \u2013 ${leg.to}`, seconds: figures_of(Math.abs(more), 1),
      price: price < words.small_price_wh ? figures_of(price, 1) : thousands(price),
    });
  };
  return {...best[name], line: name, seconds, kwh: total_kwh(line, seconds), sentences: line.legs.map(sentence)};
};

const value_between = (places, values, at) => {
  const found = places.findIndex((place) => place >= at), k = found < 0 ? places.length - 1 : Math.max(found, 1);
  return values[k - 1] + ((values[k] - values[k - 1]) * (at - places[k - 1])) / (places[k] - places[k - 1]);
};
// Values at all nodes from those at the nodes that are kept.
const spread = (places, kept, values) => {
  const at = kept.map((node) => places[node]);
  return places.map((place) => value_between(at, values, place));
};
// speed squared is what an even force moves evenly along the way
const spread_speeds = (places, kept, speeds) => spread(places, kept, speeds.map((one) => one * one)).map(Math.sqrt);

// The least energy of a time, as the greatest of the lines that are proven.
export const bound_at = ({time_s, kwh, kwh_a_second}, time) =>
  Math.max(...time_s.map((touches, k) => kwh[k] - kwh_a_second[k] * (time - touches)));

// Of a drawing, its speeds; the optimum beside it is the last of those that take no longer.
export const drawing_verdict = (lesson, text) => {
  const {course, bounds, optima, words, alike: [alike_kmh, alike_kwh]} = lesson, points = text.split(",").map(Number);
  const run = drive_drawn(course, between_points(course, points).map((kmh) => kmh / KMH_PER_MS)), account = account_of(run);
  const best = optima[Math.max(last_index(optima, (one) => one.time_s <= account.time_s), 0)];
  const used = so_far_kwh(run), times = run.sums.map((sum) => sum.time), less = figures_of(account.time_s - best.time_s, 1);
  const growth = (values, [from, to]) => value_between(course.position, values, to) - value_between(course.position, values, from);
  const sentence = ({ends_m: ends, words: stretch, mean_ms, kwh}) => {
    const faster = ((ends[1] - ends[0]) / growth(times, ends) - mean_ms) * KMH_PER_MS, more = growth(used, ends) - kwh;
    const alike = Math.abs(faster) < alike_kmh;
    if (alike && Math.abs(more) < alike_kwh) { return told(words.did_alike, {stretch}); }
    const pace = alike ? words.same_pace
      : told(words.pace, {speed: figures_of(Math.abs(faster), 0), faster: which(words.faster, faster)});
    return told(words.did, {stretch, pace, energy: figures_of(Math.abs(more), 2), more: which(words.more, more)});
  };
  return {
    ...account, points, bound_kwh: bound_at(bounds, account.time_s), proven: true, best_kwh: best.kwh, best_ms: spread_speeds(course.position, best.kept, best.ms),
    other_time: less !== "0.0",
    best_name: less === "0.0" ? words.best_name : told(words.other_time, {time: clock_of(best.time_s), less}),
    above_kwh: differences(used, spread(course.position, best.kept, best.so_far_kwh)), rows: beyond(run, best, words), stretches: best.stretches.map(sentence),
  };
};
