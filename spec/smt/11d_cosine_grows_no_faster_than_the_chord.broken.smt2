; BROKEN     Twin of 11d_cosine_grows_no_faster_than_the_chord.smt2: the cosine is taken to grow
;            with the square of the chord.
(set-info :status sat)
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
(assert (not (<= (+ (* nx (+ hx cx)) (* ny (+ hy cy))) (+ (* nx hx) (* ny hy) (* phi phi))))) ; BROKEN: phi^2 for phi
(check-sat)
