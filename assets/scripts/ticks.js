// The numbers at an axis.

import {written} from "./numbers.js";

export const tick_words = (tick, digits) => written(tick, digits, 3);
