; THEOREM    11d: turning from h to h1 raises the closing cosine by no more than the chord |h1 -
;            h|.
; ASSUMED    n, h and h1 = h + (cx, cy) are unit vectors; the chord is no longer than phi.
; CONCLUDED  n h1 <= n h + phi: a bound kappa of the cosine becomes kappa + phi.
; SOURCE     own; the cosine is 1-Lipschitz.
; TWIN       the cosine is taken to grow with the square of the chord.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const nx Real)       ; direction of the thing when seen
(declare-const ny Real)
(declare-const hx Real)       ; direction of motion then, h
(declare-const hy Real)
(declare-const cx Real)       ; chord, h1 - h
(declare-const cy Real)
(declare-const phi Real)      ; its length, at most
; Assumptions
(assert (= (+ (* nx nx) (* ny ny)) 1))
(assert (= (+ (* hx hx) (* hy hy)) 1))
(assert (= (+ (* (+ hx cx) (+ hx cx)) (* (+ hy cy) (+ hy cy))) 1))
(assert (>= phi 0))
(assert (<= (+ (* cx cx) (* cy cy)) (* phi phi)))
(assert (>= (* (- (* nx cy) (* ny cx)) (- (* nx cy) (* ny cx))) 0))   ; a square: true anyway, a hint for cvc5

; Conclusion, negated
(assert (not (<= (+ (* nx (+ hx cx)) (* ny (+ hy cy))) (+ (* nx hx) (* ny hy) phi))))
(check-sat)
