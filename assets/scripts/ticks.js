// The numbers at an axis.

import {written} from "./numbers.js";

const MOST_DIGITS = 3;

export const tick_words = (tick, digits) => written(tick, digits, MOST_DIGITS);
