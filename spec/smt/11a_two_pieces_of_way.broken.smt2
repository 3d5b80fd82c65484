; BROKEN     Twin of 11a_two_pieces_of_way.smt2: the second piece is counted with the cosine of
;            the first.
(set-info :status sat)
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
(assert (not (<= (+ (* px (+ q1x q2x)) (* py (+ q1y q2y))) (* P k1 (+ l1 l2))))) ; BROKEN: k1 for k2
(check-sat)
