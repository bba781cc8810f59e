// Which codes a family prints (app/targets/family.py); the server has the last word.

const DIGITS = 11;
const CODES = 3 ** DIGITS;
// x^5 + x^4 - x^3 + x^2 - 1 modulo 3, coefficients of descending powers.
const GOLAY_GENERATOR = [1, 1, 2, 1, 0, 2];
// Columns of the parity check for d0 ... d10.
const HAMMING_COLUMNS = ["001", "010", "011", "012", "100", "101", "102", "110", "111", "112", "120"];

const CHECKS = {
  full: () => true,
  parity: (digits) => digits.reduce((sum, digit) => sum + digit, 0) % 3 === 0,
  hamming: (digits) => [0, 1, 2].every((row) => digits.reduce((sum, digit, place) => sum + digit * HAMMING_COLUMNS[place][row], 0) % 3 === 0),
  golay: (digits) => remainder(digits).every((digit) => digit === 0),
};

/** Whether a family prints a code. */
export function familyHolds(family, code) {
  if (!Number.isInteger(code) || code <= 0 || code >= CODES) return false;
  return CHECKS[family](digitsOf(code));
}

/** Eleven ternary digits, the most significant first. */
const digitsOf = (code) => [...code.toString(3).padStart(DIGITS, "0")].map(Number);

/** What division by the Golay code's generator leaves. */
function remainder(digits) {
  const left = [...digits];
  for (let at = 0; at + GOLAY_GENERATOR.length <= left.length; at += 1) {
    const factor = left[at];
    GOLAY_GENERATOR.forEach((coefficient, index) => { left[at + index] = (left[at + index] + (3 - factor) * coefficient) % 3; });
  }
  return left;
}
