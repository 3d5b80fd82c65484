; THEOREM    11a: the geometric lemma, first part: how far a way of two pieces leads towards the
;            thing.
; ASSUMED    The robot's centre moves by q1 + q2; each piece has its length and makes with p, the
;            direction of the thing, an angle whose cosine is at most k1 or k2.
; CONCLUDED  n q <= k1 l1 + k2 l2, with n = p/|p| (both sides times |p|). With k1 = k2 = kappa it
;            is kappa l; with the first piece itself a sum, and l1 the sum of its lengths, it is
;            the step of an induction, for ways of any number of pieces.
; SOURCE     own; spec/shield.md.
; TWIN       the second piece is counted with the cosine of the first.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const px Real)       ; where the thing was seen, from the centre
(declare-const py Real)
(declare-const P Real)        ; its distance |p|
(declare-const q1x Real)      ; first piece
(declare-const q1y Real)
(declare-const l1 Real)       ; its length, or more
(declare-const k1 Real)       ; its cosine, at most
(declare-const q2x Real)      ; second piece
(declare-const q2y Real)
(declare-const l2 Real)       ; its length, or more
(declare-const k2 Real)       ; its cosine, at most
; Assumptions
(assert (and (> P 0) (= (* P P) (+ (* px px) (* py py)))))
(assert (and (>= l1 0) (>= (* l1 l1) (+ (* q1x q1x) (* q1y q1y)))))
(assert (and (>= l2 0) (>= (* l2 l2) (+ (* q2x q2x) (* q2y q2y)))))
(assert (<= (+ (* px q1x) (* py q1y)) (* k1 P l1)))
(assert (<= (+ (* px q2x) (* py q2y)) (* k2 P l2)))

; Conclusion, negated
(assert (not (<= (+ (* px (+ q1x q2x)) (* py (+ q1y q2y))) (* P (+ (* k1 l1) (* k2 l2))))))
(check-sat)
