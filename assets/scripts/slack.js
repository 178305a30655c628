// Seconds shared out among the legs of a line: what moves, and what it costs, from tables of the library's optima.

// The border behind leg k moves by some seconds, as far as both legs beside it keep the least.
export const moved = (seconds, k, by, least) => {
  const most = seconds[k + 1] - least, fewest = least - seconds[k], step = Math.min(Math.max(by, fewest), most);
  return seconds.map((one, i) => (i === k ? one + step : i === k + 1 ? one - step : one));
};

// A table holds a value for each whole second from the least on.
export const price_of = (line, seconds, k) => line.legs[k].price_wh_s[seconds[k] - line.min_s];
export const total_kwh = (line, seconds) =>
  line.legs.reduce((sum, leg, k) => sum + leg.energy_kwh[seconds[k] - line.min_s], line.standing_kwh);

export const equal_share = (line) => line.legs.map(() => line.slack_s / line.legs.length);
export const sharing_text = (name, seconds) => `${name}:${seconds.join(",")}`;
